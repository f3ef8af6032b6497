// Wave variables in whole loops: the twin delta and the arm, over networks of any delay.
#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "common/energy_budget.hpp"
#include "tests/loop/pressing.hpp"

namespace farhand::wave_test {
namespace {

constexpr double kServo = 20000;  // [N/m] in series with the wall, as the scene says

Scene wave_over(double rtt_ms, double wall, double b = 20) {
  Scene scene = pressing_over(rtt_ms, wall);
  scene.proto.mutable_compensation()->mutable_wave()->set_impedance_newton_s_per_m(b);
  return scene;
}

void expect_safe(double rtt, double wall, const Pressing& h) {
  std::printf(
      "%3.0f ms, wall %4.0f N/m: felt %.1f N/m, drag %.2f N, handle %.2f mm/s rms, robot presses "
      "%.1f N at most, operator's energy %.4f J\n",
      rtt, wall, h.stiffness, h.drag, h.chatter * 1e3, h.peak_contact, h.operator_energy);
  EXPECT_EQ(h.violations, 0u);
  EXPECT_EQ(h.method, Method::wave);
  EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
  EXPECT_GE(h.operator_energy, -kEnergyStore) << rtt << ' ' << wall;
}

// T: one way, the reconstruction and the playout, which a steady network keeps at a millisecond.
TEST(WaveLoop, FeelsTheWallInSeriesWithTheNetwork) {
  for (const double rtt : {2., 20., 100.})
    for (const double wall : {200., 1000., 5000.}) {
      const Pressing h = pressed(wave_over(rtt, wall), 12);
      const double T = rtt / 2e3 + WaveConfig{}.tau + 0.001;
      const double expected = 1 / (1 / wall + T / 20 + 1 / kServo);
      expect_safe(rtt, wall, h);
      EXPECT_NEAR(h.stiffness / expected, 1, 0.10) << rtt << ' ' << wall;
    }
}

TEST(WaveLoop, GivesTheHandNoEnergyOverABadNetwork) {
  for (const double wall : {200., 1000., 5000.}) {
    Scene scene = wave_over(100, wall);
    worsen(scene, 10);
    expect_safe(100, wall, pressed(scene, 6));
  }
}

// What every tick felt and told the robot, over a network that delivers each datagram once or,
// 7 ms later, again.
std::vector<double> traced(bool twice) {
  Loopback loop(wave_over(20, 1000), {.duration_s = 9});
  struct Again {
    TimePoint at;
    Side to;
    std::vector<std::byte> bytes;
  };
  std::deque<Again> again;
  std::vector<double> out;
  if (twice)
    loop.on_sent = [&](Side to, std::span<const std::byte> d) {
      again.push_back({loop.now() + std::chrono::milliseconds(17), to, {d.begin(), d.end()}});
    };
  loop.on_master = [&](const MasterTick& t) {
    out.insert(out.end(), t.F_G.force.begin(), t.F_G.force.end());
    for (; !again.empty() && again.front().at <= loop.now(); again.pop_front())
      loop.inject(again.front().to, again.front().bytes);
  };
  loop.on_slave = [&](const SlaveTick& t) {
    out.insert(out.end(), t.X_SE_target.p.begin(), t.X_SE_target.p.end());
  };
  loop.run();
  EXPECT_TRUE(!twice || (*loop.slave_link())[Verdict::duplicate] > 8000);
  return out;
}

TEST(WaveLoop, ResultsAreTheSameWithEveryDatagramTwice) {
  EXPECT_EQ(traced(false), traced(true));
}

}  // namespace
}  // namespace farhand::wave_test
