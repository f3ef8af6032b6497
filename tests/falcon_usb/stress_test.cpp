// The driver against a device at its worst: FARHAND_STRESS_TICKS sets how many milliseconds.
#include "tests/support/stress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/falcon_usb/rig.hpp"

namespace farhand::falcon_usb {
namespace {

const SerialFaults kSerial{
    .lost = 0.01, .duplicated = 0.01, .garbage = 0.01, .cut = 0.01, .delayed = 0.01};
constexpr BusFaults kBus{.split = 0.05, .held = 0.02};

// Passes everything on and looks at every sample the driver takes.
struct Watched {
  Rig& rig;
  std::size_t next_shown = 0;  // no earlier answer than the last one taken may follow
  TimePoint last_at = rig.now;
  std::uint64_t unanswered = 0, samples = 0, wrong = 0;
  std::optional<TimePoint> asked;  // first since the last sample
  Duration worst_recovery{};       // from a question that was unanswered once to its sample
  Duration worst_gap{};            // between samples

  void hear(const Event& event, TimePoint now) noexcept {
    const auto before = rig.driver.sample();
    rig.driver.hear(event, now);
    const auto& sample = rig.driver.sample();
    if (sample && (!before || before->at != sample->at)) judge(*sample);
  }
  std::optional<Request> next(TimePoint now) noexcept {
    const auto request = rig.driver.next(now);
    if (request && !asked) asked = now;
    return request;
  }
  TimePoint due() const noexcept { return rig.driver.due(); }

  void judge(const Sample& sample) {
    ++samples;
    const auto& shown = rig.grip.shown;
    const auto match = std::find_if(
        shown.begin() + static_cast<std::ptrdiff_t>(next_shown), shown.end(), [&](const auto& s) {
          return s.counts == sample.answer.encoders && s.at >= sample.at - sample.age;
        });
    if (match == shown.end())
      ++wrong;
    else
      next_shown = static_cast<std::size_t>(match - shown.begin());
    const std::uint64_t asked_again = rig.driver.status().exchange.unanswered;
    if (asked_again == unanswered + 1)
      worst_recovery = std::max(worst_recovery, sample.at - asked.value());
    worst_gap = std::max(worst_gap, sample.at - last_at);
    asked.reset();
    unanswered = asked_again;
    last_at = sample.at;
  }
  void live(std::uint64_t ticks) {
    last_at = rig.now;
    for (std::uint64_t i = 0; i < ticks; ++i) {
      rig.driver.write(rig.now, rig.tau);
      run(rig.emulator, *this, rig.now, rig.now + 1ms);
    }
  }
};

// Armed, and from then on watched.
struct Stress {
  explicit Stress(std::uint64_t seed)
      : rig({.processor = {.firmware_loaded = true}, .seed = seed}, {.pacing = Pacing::device}) {
    EXPECT_TRUE(rig.arm());
    rig.grip.logs = true;
    rig.live(10ms);
  }
  Rig rig;
  Watched watched{.rig = rig};
};

TEST(FalconStress, NoSampleIsWrongAndALostAnswerIsMadeGoodWithin5Ms) {
  for (const std::uint64_t seed : {1u, 2u}) {
    Stress s(seed);
    s.rig.emulator.set_faults(kSerial, kBus);
    const std::uint64_t ticks = stress_ticks(20000);
    s.watched.live(ticks);
    const DriverStatus status = s.rig.driver.status();
    EXPECT_EQ(s.watched.wrong, 0u) << seed;
    EXPECT_LE(s.watched.worst_recovery, 5ms) << seed;
    EXPECT_LE(s.watched.worst_gap, DriverConfig{}.unanswered) << seed;
    EXPECT_EQ(s.rig.phase(), Phase::armed) << seed;
    // The faults did happen, and cost no more than they must.
    EXPECT_GT(status.exchange.unanswered, ticks / 100);
    EXPECT_GT(status.exchange.surplus, ticks / 1000);
    EXPECT_GT(status.skipped_bytes, ticks / 100);
    EXPECT_GT(s.watched.samples, ticks * 3 / 4);
  }
}

// Plugs pulled, power cut, buttons pressed at random, under all faults: torque reaches the motors
// only while the driver is armed, or left it within the last exchange.
TEST(FalconStress, TorqueLeavesOnlyWhileArmedWhateverHappens) {
  Stress s(3);
  Rig& rig = s.rig;
  BusFaults bus = kBus;
  bus.failed = bus.hung = 0.0002;
  rig.emulator.set_faults(kSerial, bus);
  Random random(3);
  const auto once_in = [&](int n) { return random.uniform() * n < 1; };
  TimePoint armed_at = rig.now;
  int times_armed = 0;
  for (std::uint64_t i = 0; i < stress_ticks(60000); ++i) {
    if (once_in(3000)) rig.emulator.unplug(rig.now);
    if (once_in(500) && rig.phase() == Phase::absent) rig.emulator.plug(rig.now);
    if (once_in(8000)) rig.emulator.cut_power();
    if (once_in(500) && rig.phase() == Phase::failed) {
      rig.emulator.restore_power();
      rig.emulator.load_firmware();
      rig.emulator.plug(rig.now);
    }
    if (once_in(700)) rig.grip.buttons = static_cast<std::uint8_t>(random.bits() % 16);
    if (once_in(700)) rig.grip.buttons = kGesture;
    const bool was_armed = rig.phase() == Phase::armed;
    if (was_armed) armed_at = rig.now;
    rig.live(1ms);
    if (rig.phase() == Phase::armed) armed_at = rig.now;
    times_armed += !was_armed && rig.phase() == Phase::armed;
    ASSERT_LE(rig.grip.last_driven, armed_at + 1ms) << i;
  }
  EXPECT_GT(times_armed, 5);
  EXPECT_GT(rig.driver.status().unplugged, 5u);
}

// A letter that became another one is a packet like any: what it may do to a sample is bounded by
// how fast a hand can be.
TEST(FalconStress, AnAlteredLetterMovesASampleByNoMoreThanAHandCould) {
  Stress s(2);
  s.rig.emulator.set_faults({.altered = 0.01}, {});
  double worst = 0;
  for (std::uint64_t i = 0; i < stress_ticks(20000); ++i) {
    s.rig.live(1ms);
    if (!s.rig.driver.sample()) continue;
    for (int k = 0; k < 3; ++k)
      worst = std::max<double>(worst, std::abs(s.rig.driver.sample()->answer.encoders[k] -
                                               s.rig.grip.shown.back().counts[k]));
  }
  EXPECT_GT(s.rig.driver.status().implausible, 0u);
  // In the time from the sample before, two steps at most with a rejected one between, and as much
  // back at the swing's speed.
  const double reach = PlausibilityConfig{}.max_rate / theta1_quantum(kFalconTable1);
  EXPECT_LE(worst, 1 + 0.0035 * (reach + 600 * 2 * std::numbers::pi));
}

TEST(FalconStress, TheSameSeedGivesTheSameBits) {
  const auto digest = [](std::uint64_t seed) {
    Stress s(seed);
    s.rig.emulator.set_faults(kSerial, kBus);
    s.watched.live(3000);
    const DriverStatus status = s.rig.driver.status();
    return std::tuple(s.watched.samples, status.exchange.asked, status.exchange.surplus,
                      status.skipped_bytes, s.rig.driver.sample()->answer.encoders,
                      s.rig.driver.sample()->at, s.rig.grip.drives);
  };
  EXPECT_EQ(digest(5), digest(5));
  EXPECT_NE(digest(5), digest(6));
}

}  // namespace
}  // namespace farhand::falcon_usb
