// What the hand does on the bench, and the figures of it: 1 s of rest, in which the sides hear of
// each other, 4 s of a free sine of 0.5 Hz and 25 mm, a ramp to 20 mm beyond the wall, 4 s held,
// and back.
#pragma once

#include <algorithm>
#include <numbers>

#include "tests/compensation/bench.hpp"

namespace farhand::bench {

inline constexpr double kRest = 1, kFree = 5, kRamp = 2, kHold = 4, kAfter = 1;
inline constexpr double kWall = 0.04, kBeyond = 0.02;

inline double wished_place(double t, double hold) {
  if (t < kFree) return 0.025 * std::sin(std::numbers::pi * std::max(t - kRest, 0.0));
  const double in = std::clamp((t - kFree) / kRamp, 0.0, 1.0);
  const double out = std::clamp((t - kFree - kRamp - hold) / kRamp, 0.0, 1.0);
  return (kWall + kBeyond) * (in - out);
}
inline Wish wish(double t, double hold) {
  const double x = wished_place(t, hold);
  return {x, (x - wished_place(t - Bench::kTs, hold)) / Bench::kTs};
}

struct Figures {
  double rmse = 0;            // [m] robot against the handle T1 before, free from its second s on
  double drag = 0;            // [N] mean |F|, free from its second s on
  double force = 0;           // [N] felt, last second of the hold
  double felt = 0;            // stiffness felt over the wall's, last second of the hold
  double chatter = 0;         // [m/s] RMS of the faster of both sides, last 2 s of the hold
  double least = 0;           // [J] least energy that went into the network, both ports
  double operator_least = 0;  // [J] at the hand
  double peak_F = 0, peak_F_e = 0;  // [N]
  double lag = 0;                   // [m] |x_m - x_s| at the end
  bool finite = true;
};

// T1 [s]: of the way there. `each` is given every sample.
template <typename Each>
Figures run(const Rig& rig, Method& method, double T1, Each&& each) {
  Bench bench(rig, method);
  Figures f;
  std::vector<double> x_m;
  double rmse = 0, drag = 0, v2m = 0, v2s = 0, force = 0, depth = 0;
  int free = 0, held = 0, last = 0;
  const auto lead = static_cast<std::size_t>(std::lround(T1 / Bench::kTs));
  const double end = kFree + 2 * kRamp + rig.hold + kAfter;
  const int ticks = static_cast<int>(std::lround(end / Bench::kTs));
  for (int i = 0; i < ticks; ++i) {
    const double t = i * Bench::kTs;
    const Sample& a = bench.tick(wish(t, rig.hold), wish(t + Bench::kTs, rig.hold));
    each(a);
    x_m.push_back(a.x_m);
    f.least = std::min(f.least, a.energy);
    f.operator_least = std::min(f.operator_least, a.operator_energy);
    f.peak_F = std::max(f.peak_F, std::abs(a.F)), f.peak_F_e = std::max(f.peak_F_e, a.F_e);
    f.finite = f.finite && std::abs(a.x_m) < 1 && std::abs(a.x_s) < 1;
    if (!f.finite) break;
    if (t >= kRest + 1 && t < kFree) {
      const double e = a.x_s - x_m[x_m.size() - 1 - std::min(lead, x_m.size() - 1)];
      rmse += e * e, drag += std::abs(a.F), ++free;
    }
    const double left = kFree + kRamp + rig.hold - t;  // of the hold
    if (left > 0 && left <= 2) v2m += a.v_m * a.v_m, v2s += a.v_s * a.v_s, ++held;
    if (left > 0 && left <= 1) force += a.F, depth += a.x_m - kWall, ++last;
    f.lag = std::abs(a.x_m - a.x_s);
  }
  if (held == 0) return f;
  f.rmse = std::sqrt(rmse / free), f.drag = drag / free;
  f.force = force / last;
  f.felt = force / depth / rig.wall.k;
  f.chatter = std::sqrt(std::max(v2m, v2s) / held);
  return f;
}
inline Figures run(const Rig& rig, Method& method, double T1) {
  return run(rig, method, T1, [](const Sample&) {});
}

}  // namespace farhand::bench
