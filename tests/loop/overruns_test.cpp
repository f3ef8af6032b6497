// Both loops on a virtual clock that takes no time but where a test says so: what is put in must be
// what is counted, to the nanosecond.
#include <gtest/gtest.h>

#include <array>

#include "master/build.hpp"
#include "slave/build.hpp"
#include "tests/support/virtual_clock.hpp"

namespace farhand {
namespace {

using std::chrono::microseconds;

constexpr Duration kPeriod = std::chrono::milliseconds(1);
constexpr Duration kNanosecond{1};

enum class Fault { woken_late, withheld, busy };  // by whom: the machine, the machine, ourselves

struct Counted {
  std::uint64_t turns = 0, overruns = 0;
  Duration own{}, machine{};

  void add(const LoopTiming& t) {
    ++turns;
    overruns += t.overrun ? 1 : 0;
    own += t.overrun_own;
    machine += t.overrun_machine;
  }
};

void put_in(Fault fault, Duration length) {
  (fault == Fault::woken_late ? virtual_clock.late : virtual_clock.stall) = length;
  virtual_clock.busy = fault == Fault::busy;
}

// Four turns to a fault, so that none meets another's consequences. `slack` is the longest fault
// that is still in time.
template <typename Loop>
Counted provoke(Loop& loop, Duration slack) {
  const std::array lengths = {kNanosecond,
                              slack / 2,
                              slack,
                              slack + kNanosecond,
                              slack + kPeriod / 3,
                              3 * kPeriod,
                              7 * kPeriod + microseconds(1)};
  Counted expected;
  for (int round = 0; round < 20; ++round)
    for (const Fault fault : {Fault::woken_late, Fault::withheld, Fault::busy})
      for (const Duration length : lengths) {
        put_in(fault, length);
        for (int i = 0; i < 4; ++i) loop.turn();
        expected.turns += 4;
        if (length <= slack) continue;
        ++expected.overruns;
        (fault == Fault::busy ? expected.own : expected.machine) += length - slack;
      }
  return expected;
}

void expect_same(const Counted& counted, const Counted& expected) {
  EXPECT_EQ(counted.turns, expected.turns);
  EXPECT_EQ(counted.overruns, expected.overruns);
  EXPECT_EQ(counted.own, expected.own);
  EXPECT_EQ(counted.machine, expected.machine);
  EXPECT_GT(counted.overruns, 200u);
}

struct Overruns : testing::Test {
  Overruns() { virtual_clock = {.on = true}; }
  ~Overruns() override { virtual_clock = {}; }
};

Scene scene_of(const char* name) {
  return load_scene(std::string(FARHAND_SOURCE_DIR "/deploy/scenes/") + name);
}

TEST_F(Overruns, OfTheMasterAreCountedExactlyAndLaidAtTheRightDoor) {
  const Scene scene = scene_of("falcon_f1.textproto");
  Master master(master_config(scene.proto));
  AnyDevice device = make_device(scene, {}, 1);
  Counted counted;
  Recorder<MasterRecord> recorder([&](const MasterRecord& r) { counted.add(r.timing); });
  MasterLoop loop({.period = kPeriod}, master, device, nullptr, nullptr, nullptr, recorder);
  const Counted expected = provoke(loop, kPeriod);
  recorder.stop();
  ASSERT_EQ(recorder.lost(), 0u);
  expect_same(counted, expected);
}

// A slave that hears nobody, so that every tick comes at its deadline.
struct LoneSlave {
  explicit LoneSlave(Duration spin = {})
      : loop({.period = kPeriod, .spin = spin}, slave, robot, link, socket, recorder) {}

  Scene scene = scene_of("minimal.textproto");
  Slave slave{slave_config(scene.proto)};
  AnyRobot robot = make_robot(scene.proto, 1);
  UdpSocket socket{parse_udp_address("127.0.0.1:0")};
  SlaveLink link{{.session = 2, .scene_hash = scene.shared_hash}};
  Counted counted;
  Recorder<SlaveRecord> recorder{[this](const SlaveRecord& r) { counted.add(r.timing); }};
  SlaveLoop loop;
};

TEST_F(Overruns, OfTheSlaveAreCountedExactlyAndLaidAtTheRightDoor) {
  LoneSlave side;
  virtual_clock.at = VirtualClock::Wait::socket;
  const Counted expected = provoke(side.loop, kPeriod / 2);
  side.recorder.stop();
  ASSERT_EQ(side.recorder.lost(), 0u);
  expect_same(side.counted, expected);
}

// The same clock shows what a spin is worth.
struct Spin : Overruns {
  static constexpr Duration kSpin = microseconds(100);
  TimePoint until = TimePoint(virtual_clock.now + kPeriod);
  Spin() { virtual_clock.reading = microseconds(1); }
};

TEST_F(Spin, WatchesTheClockForTheLastOfTheSleepOnly) {
  sleep_until(until, kSpin);
  EXPECT_EQ(TimePoint(virtual_clock.asleep_until), until - kSpin);
  EXPECT_EQ(virtual_clock.readings, 101);
  EXPECT_EQ(monotonic_now() - until, microseconds(1));
}

TEST_F(Spin, ASleepThatEndsLateByLessThanItIsInTime) {
  virtual_clock.late = microseconds(99);
  sleep_until(until, kSpin);
  EXPECT_EQ(monotonic_now() - until, microseconds(1));
  virtual_clock.late = microseconds(99);
  sleep_until(until + kPeriod, Duration::zero());
  EXPECT_EQ(monotonic_now() - (until + kPeriod), microseconds(99));
}

TEST_F(Spin, DoesNotBeginAfterASignal) {
  virtual_clock.interrupted = true;
  sleep_until(until, kSpin);
  EXPECT_EQ(virtual_clock.readings, 0);
}

// A round of a spin reads the clock twice, so takes 2 us here. The few rounds more or less a turn
// are where it begins and ends.
constexpr int kTurns = 100;
constexpr microseconds kRound(2);

TEST_F(Spin, OfTheMasterBeginsWithTheWaitForTheAnswer) {
  const Scene scene = scene_of("minimal.textproto");
  UdpSocket slave(parse_udp_address("127.0.0.1:0"));  // never answers
  UdpSocket socket(parse_udp_address("127.0.0.1:0"), slave.local());
  const auto polls = [&](Duration spin) {
    Master master(master_config(scene.proto));
    AnyDevice device = make_device(scene, {}, 1);
    MasterLink link({.session = 1, .scene_hash = scene.shared_hash});
    Recorder<MasterRecord> recorder([](const MasterRecord&) {});
    MasterLoop loop({.period = kPeriod, .spin = spin}, master, device, &link, &socket, nullptr,
                    recorder);
    virtual_clock.now = Duration::zero();  // where a loop that nobody runs begins
    virtual_clock.polls_at_once = 0;
    for (int i = 0; i < kTurns; ++i) loop.turn();
    return virtual_clock.polls_at_once;
  };
  const int without = polls(Duration::zero());
  EXPECT_NEAR(polls(kSpin) - without, kTurns * (kSpin / kRound), 3 * kTurns);
}

TEST_F(Spin, OfTheSlaveIsAsLongBeforeTheExpectedMessageAsAfterIt) {
  const auto polls = [](Duration spin) {
    LoneSlave side(spin);
    virtual_clock.polls_at_once = 0;
    for (int i = 0; i < kTurns; ++i) side.loop.turn();
    side.recorder.stop();
    EXPECT_EQ(side.counted.overruns, 0u);
    return virtual_clock.polls_at_once;
  };
  const int without = polls(Duration::zero());
  EXPECT_NEAR(polls(kSpin) - without, kTurns * (2 * kSpin / kRound), 3 * kTurns);
}

}  // namespace
}  // namespace farhand
