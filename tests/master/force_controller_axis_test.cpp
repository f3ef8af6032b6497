// The product's force controller on one axis of the reference's model (sections 9.2-9.4, 10), with
// the published gains and with the stages that go beyond them. Every figure is printed.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/axis_loops.hpp"

namespace farhand::axis {
namespace {

LoopConfig noisy(ForceControllerConfig controller) {
  return {.force_noise = 0.03, .encoder_step = 20e-6, .controller = std::move(controller)};
}

// What the controller takes away of the open loop's figures, on the same axis.
struct Gone {
  double per_mm, component, mean, felt, noise;
};
Gone gone(const LoopConfig& config, double hz = 1) {
  LoopConfig open = config;
  open.controller = open_loop();
  const double amplitude = std::min(0.05, 0.05 / hz), settle = hz < 1 ? 4 : 3;
  const int periods = hz < 1 ? 2 : 4;
  const Swing a = swing(open, hz, amplitude, settle, periods);
  const Swing b = swing(config, hz, amplitude, settle, periods);
  return {1 - b.per_mm / a.per_mm, 1 - b.component / a.component, b.mean, b.felt,
          b.noise / a.noise};
}
void print(const char* what, const Gone& g) {
  std::printf(
      "%-26s swing per mm -%.1f %%, component -%.1f %%, mean %.4f N, felt noise %.1f mN, "
      "measured noise x %.3f\n",
      what, 100 * g.per_mm, 100 * g.component, g.mean, 1e3 * g.felt, g.noise);
}

// 40 s of 1 Hz, judged from 30 s, as published.
TEST(ForceControllerAxis, H1WithThePublishedGains) {
  const Swing open = swing({.controller = open_loop()}, 1, 0.05, 30, 10);
  const Swing closed = swing({.controller = published()}, 1, 0.05, 30, 10);
  const double swing_gone = 1 - closed.per_mm / open.per_mm;
  std::printf("open loop: mean %.3f N, peak %.2f N, half swing %.2f N\n", open.mean, open.peak,
              open.half);
  std::printf("published: mean %.4f N, peak %.2f N, half swing %.2f N, swing per mm -%.1f %%\n",
              closed.mean, closed.peak, closed.half, 100 * swing_gone);
  EXPECT_NEAR(open.mean, 2.00, 0.02);
  EXPECT_NEAR(open.peak, 5.60, 0.06);
  EXPECT_NEAR(closed.peak, 1.61, 0.02);
  EXPECT_LE(closed.peak, 0.4 * open.peak);
  EXPECT_LE(std::abs(closed.mean), 0.05);
  EXPECT_GE(swing_gone, 0.50);
  EXPECT_LE(swing_gone, 0.60);
}

TEST(ForceControllerAxis, H1BeyondThePublicationOnEveryCornerOfTheDevice) {
  for (int k = -1; k < 16; ++k) {  // first the device as the model has it
    LoopConfig c = noisy(ours(1));
    const auto off = [&](int bit) { return k < 0 ? 1 : (k >> bit) & 1 ? 1.2 : 0.8; };
    c.device = {c.device.m * off(0), c.device.B * off(1), c.device.F_k * off(2),
                c.device.F_g * off(3)};
    const Gone g = gone(c);
    char name[40];
    std::snprintf(name, sizeof name, "m %.1f B %.1f Fk %.2f Fg %.1f", c.device.m, c.device.B,
                  c.device.F_k, c.device.F_g);
    print(name, g);
    EXPECT_GE(g.per_mm, 0.94) << name;
    EXPECT_GE(g.component, 0.98) << name;
    EXPECT_LE(std::abs(g.mean), 0.01) << name;
    EXPECT_LE(g.felt, 0.015) << name;
    EXPECT_LE(g.noise, 1.1) << name;
  }
}

TEST(ForceControllerAxis, H1BeyondThePublicationForEveryHandAndFrequency) {
  for (const double mass : {0.2, 1.0, 4.0}) {
    LoopConfig c = noisy(ours(1));
    c.hand.m = mass;
    const Gone g = gone(c);
    std::printf("hand %.1f kg: ", mass);
    print("", g);
    EXPECT_GE(g.per_mm, 0.87) << mass;
  }
  for (const double hz : {0.25, 0.5, 2.0, 4.0}) {
    const Gone g = gone(noisy(ours(1)), hz);
    std::printf("%.2f Hz: ", hz);
    print("", g);
    EXPECT_GE(g.per_mm, hz > 2 ? 0.88 : 0.93) << hz;
  }
}

TEST(ForceControllerAxis, TheWholeCommandMayDoubleBeforeItsMargin) {
  for (const double mass : {0.4, 4.0}) {
    LoopConfig c = noisy(ours(1)), p = noisy(published());
    c.hand.m = p.hand.m = mass;
    const double margin = margin_db(c);
    std::printf("hand %.1f kg: gain margin %.1f dB, published %.1f dB\n", mass, margin,
                margin_db(p));
    EXPECT_GE(margin, 6) << mass;
    EXPECT_LT(margin, 23) << "the probe finds no end";
  }
}

TEST(ForceControllerAxis, ASlowPlantIsHiddenTooWithItsOwnGains) {
  LoopConfig c = noisy(ours_slow(3));
  c.queue = 2, c.motor_hz = 150, c.sensor_hz = 200;
  const Gone g = gone(c);
  const double margin = margin_db(c);
  print("2 ms, 150 Hz, 200 Hz", g);
  std::printf("gain margin %.1f dB\n", margin);
  EXPECT_GE(g.per_mm, 0.88);
  EXPECT_GE(margin, 6);
}

LoopConfig wall(ForceControllerConfig controller, double stiffness, int delay) {
  LoopConfig c = noisy(std::move(controller));
  c.queue = 0;
  c.delay = delay;
  c.wall = Wall{.k = stiffness};
  return c;
}

TEST(ForceControllerAxis, H2H3TheUserFeelsTheWall) {
  for (const double k : {500.0, 1000.0})
    for (const int delay : {2, 20}) {
      const Contact open = contact(wall(open_loop(), k, delay));
      const Contact paper = contact(wall(published(), k, delay));
      const Contact own = contact(wall(ours(0), k, delay));
      std::printf(
          "%4.0f N/m, %2d+%2d ms: F_u - F_e open %.2f N rms, published %.3f (x %.2f), ours "
          "%.3f (x %.3f), largest F_e %.1f, %.1f, %.1f N\n",
          k, delay, delay, open.rms, paper.rms, paper.rms / open.rms, own.rms, own.rms / open.rms,
          open.F_e, paper.F_e, own.F_e);
      EXPECT_GT(open.rms, 1.9);
      EXPECT_LE(paper.rms, 0.25 * open.rms);
      EXPECT_LE(own.rms, 0.10 * open.rms);
      EXPECT_LE(own.rms, 0.2);
      EXPECT_LT(own.peak, 0.5) << "not settled";
    }
}

}  // namespace
}  // namespace farhand::axis
