// Master and slave of the fullest scene take 60 000 turns each over sockets of this machine, in
// real time, encrypted, each on a thread under guard (tests/support/purity.hpp). The scene runs at
// 4000 Hz, so that the test takes about 15 s. Ageing is switched off: a machine that stalls the
// test shall not end the engagement and with it what is tested. The machine may make turns late at
// any time; each late turn reads the processor clock once, which is the one system call let through
// beyond the socket's and the sleep's, and is counted here against the overruns recorded.
#include <gtest/gtest.h>

#include "tests/support/purity.hpp"

#ifdef FARHAND_NO_PURITY

TEST(PureLoop, TurnsNeitherAllocateNorLockNorCallTheSystem) {
  GTEST_SKIP() << FARHAND_NO_PURITY;
}

#else

#include <atomic>
#include <mutex>
#include <thread>

#include "common/program.hpp"
#include "master/build.hpp"
#include "slave/build.hpp"
#include "tests/support/dtls_ends.hpp"

namespace farhand {
namespace {

constexpr std::uint64_t kWarmUp = 400;
constexpr std::uint64_t kTurns = 60'000;
constexpr Duration kNever = std::chrono::hours(1);

struct SideFigures {
  std::uint64_t turns = 0;  // recorded, warm-up included, as all here but clock_readings
  std::uint64_t records_lost = 0;
  std::uint64_t coupled = 0;
  std::uint64_t touching = 0;  // the tool touches; the hand feels it
  std::uint64_t guarded_overruns = 0;
  std::uint64_t clock_readings = 0;  // while guarded
  std::uint64_t received = 0;
};
struct Figures {
  Impurity impurity;
  SideFigures master, slave;
};

template <typename Record>
void count(SideFigures& f, const Record& r, bool coupled, bool touching) {
  ++f.turns;
  f.coupled += coupled ? 1 : 0;
  f.touching += touching ? 1 : 0;
  f.guarded_overruns += r.timing.overrun && f.turns > kWarmUp ? 1 : 0;
  f.received = r.link.received;
}

// `done` is the last thing this thread says.
template <typename Loop>
void take_turns(Loop loop, const char* who, SideFigures& figures, std::atomic<bool>& done) {
  for (std::uint64_t i = 0; i < kWarmUp; ++i) loop.turn();
  guard_this_thread(who);
  for (std::uint64_t i = 0; i < kTurns; ++i) loop.turn();
  figures.clock_readings = cpu_clock_readings;
  done = true;
  for (;;) sleep_until(TimePoint::max());
}

Scene fast_scene() {
  Scene scene = load_scene(FARHAND_SOURCE_DIR "/deploy/scenes/full.textproto");
  scene.proto.set_rate_hz(4000);
  scene.proto.mutable_slave()->mutable_sim_arm()->set_rate_hz(4000);
  scene.proto.mutable_slave()->mutable_workspace()->set_alignment_deg(90);  // the clutch goes on
  return scene;
}

MasterConfig ageless(MasterConfig c) {
  c.stale = kNever;
  return c;
}
SlaveConfig ageless(SlaveConfig c) {
  c.stale = kNever;
  return c;
}

void run_both_sides(Figures& figures) {
  const Scene scene = fast_scene();
  const UdpAddress here = parse_udp_address("127.0.0.1:0");
  std::atomic<bool> master_done = false, slave_done = false;

  Slave slave(ageless(slave_config(scene.proto)));
  AnyRobot robot = make_robot(scene.proto, scene.proto.seed());
  UdpSocket slave_socket(here);
  SecureService slave_secure({}, test_key(1));
  SlaveLink slave_link(
      {.session = 2, .scene_hash = scene.shared_hash, .secure = &slave_secure.channel()});
  Recorder<SlaveRecord> slave_recorder([&](const SlaveRecord& r) {
    count(figures.slave, r, r.tick.coupled, r.tick.F_E_S.force.norm() > 1);
  });
  SlaveLoopConfig slave_times = slave_loop_config(scene.proto);
  slave_times.lost = kNever;

  Master master(ageless(master_config(scene.proto)));
  AnyDevice device = make_device(scene, {}, scene.proto.seed());
  UdpSocket master_socket(here, slave_socket.local());
  SecureService master_secure({.server = slave_socket.local()}, test_key(1));
  MasterLink master_link(
      {.session = 1, .scene_hash = scene.shared_hash, .secure = &master_secure.channel()});
  Recorder<MasterRecord> master_recorder([&](const MasterRecord& r) {
    count(figures.master, r, r.tick.coupled, r.tick.F_G.force.norm() > 1);
  });
  MasterLoopConfig master_times = master_loop_config(scene.proto);
  master_times.lost = kNever;
  master_times.cut_off = master_times.period * 2 / 5;

  std::thread([&] {
    take_turns(SlaveLoop(slave_times, slave, robot, slave_link, slave_socket, slave_recorder),
               "the slave's turn", figures.slave, slave_done);
  }).detach();
  std::thread([&] {
    take_turns(MasterLoop(master_times, master, device, &master_link, &master_socket, nullptr,
                          master_recorder),
               "the master's turn", figures.master, master_done);
  }).detach();
  while (!master_done || !slave_done) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  master_recorder.stop();
  slave_recorder.stop();
  figures.master.records_lost = master_recorder.lost();
  figures.slave.records_lost = slave_recorder.lost();
  _exit(0);  // the loops' threads stay asleep to the end
}

void expect_full_run(const char* side, const SideFigures& f) {
  SCOPED_TRACE(side);
  EXPECT_EQ(f.turns + f.records_lost, kWarmUp + kTurns);
  EXPECT_GT(f.received, 0u);
  EXPECT_GT(f.coupled, 0u);
  EXPECT_GT(f.touching, 0u);
  EXPECT_GE(f.clock_readings, f.guarded_overruns);
  EXPECT_LE(f.clock_readings, f.guarded_overruns + f.records_lost);
  std::printf(
      "%s: %lu turns, %lu coupled, %lu touching, %lu overruns, %lu datagrams, %lu records lost\n",
      side, f.turns, f.coupled, f.touching, f.guarded_overruns, f.received, f.records_lost);
}

// The child's exit status, or -1 when a signal ended it.
int exit_status(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(PureLoop, TurnsNeitherAllocateNorLockNorCallTheSystem) {
  auto& figures = shared_with_children<Figures>();
  impurity = &figures.impurity;
  const int status = run_in_child([&] { run_both_sides(figures); });
  if (exit_status(status) == kNoGuard) GTEST_SKIP() << "this system has no seccomp filters";
  ASSERT_STREQ(figures.impurity.text, "");
  ASSERT_EQ(exit_status(status), 0) << "status " << status;
  expect_full_run("master", figures.master);
  expect_full_run("slave", figures.slave);
}

// What the guard makes of a turn that is not pure.
struct Guard : testing::Test {
  std::string caught(const std::function<void()>& turn) {
    auto& shared = shared_with_children<Impurity>();
    impurity = &shared;
    const int status = run_in_child([&] {
      guard_this_thread("turn");
      turn();
      _exit(0);
    });
    EXPECT_EQ(exit_status(status), shared.text[0] == 0 ? 0 : kImpure);
    return shared.text;
  }
};

TEST_F(Guard, LetsThroughWhatATurnNeeds) {
  UdpSocket socket(parse_udp_address("127.0.0.1:0"));
  socket.set_peer(socket.local());
  EXPECT_EQ(caught([&] {
              std::array<std::byte, 4> bytes{};
              socket.send(bytes);
              socket.wait_readable(monotonic_now());
              socket.set_deadline(monotonic_now());
              socket.wait_readable();
              socket.receive(bytes);
              sleep_until(monotonic_now() + std::chrono::microseconds(1));
              OverrunSplit().split({}, {});
            }),
            "");
}

TEST_F(Guard, CatchesAnAllocation) {
  EXPECT_EQ(caught([] { std::vector<int> v(100); }), "turn: malloc");
}

TEST_F(Guard, CatchesALockThatNobodyHolds) {
  std::mutex mutex;
  EXPECT_EQ(caught([&] { std::lock_guard lock(mutex); }), "turn: pthread_mutex_lock");
}

TEST_F(Guard, CatchesASystemCallAndNamesIt) {
  EXPECT_EQ(caught([] { getppid(); }), "turn: system call " + std::to_string(SYS_getppid));
  EXPECT_EQ(caught([] { std::fputs("x", stderr); }),
            "turn: system call " + std::to_string(SYS_write));
}

TEST_F(Guard, CatchesEveryClockThatCallsTheSystemButTheThreadsOwn) {
  timespec t;
  EXPECT_EQ(caught([&] { clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t); }),
            "turn: system call " + std::to_string(SYS_clock_gettime));
}

}  // namespace
}  // namespace farhand

#endif
