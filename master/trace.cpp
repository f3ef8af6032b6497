#include "master/trace.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

namespace farhand {
namespace {

constexpr double kControlStep = 0.012;  // [s]
constexpr double kShortestLead = 1;     // [s] from rest in the centre to rest at the first point
constexpr double kRampTime = 0.5;       // [s] from rest to full rate, and back at the end
constexpr int kEaseSteps = 25;          // control steps over which the rate is eased, each side

using Points = std::vector<Vec6>;

// ---- rotation

Quat mean_orientation(const std::vector<Quat>& q) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const Quat& x : q) sum += x.coeffs();
  return sum.norm() > 0 ? Quat(sum.normalized()) : q.front();
}

// Swing-twist about z: q = tilt * twist, near the previous twist modulo a whole turn.
Vec3 tilt_and_twist(const Quat& q, double previous_twist) {
  const double half = std::atan2(q.z(), q.w());
  const double twist =
      previous_twist + std::remainder(2 * half - previous_twist, 2 * std::numbers::pi);
  const Quat swing = q * Quat(std::cos(half), 0, 0, -std::sin(half));
  const Vec3 tilt = rotation_vector(swing.toRotationMatrix());
  return {tilt.x(), tilt.y(), twist};
}

Points recorded_points(const Recording& recording, const TraceConfig& config) {
  Points points(recording.p.size(), Vec6::Zero());
  const bool turns = !recording.q.empty() && config.rotation_scale > 0;
  const Quat mean = turns ? mean_orientation(recording.q) : Quat::Identity();
  double twist = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].head<3>() = recording.p[i];
    if (!turns) continue;
    Vec3 turn = tilt_and_twist(recording.q[i] * mean.conjugate(), twist);
    twist = turn.z();
    turn *= config.rotation_scale;
    const double tilt = turn.head<2>().norm();
    if (tilt > config.max_tilt) turn.head<2>() *= config.max_tilt / tilt;
    points[i].tail<3>() = turn;
  }
  return points;
}

// ---- resampling

// The recording joined by straight lines, held beyond its ends, with its running integral.
class Polyline {
 public:
  Polyline(const std::vector<double>& t, const Points& x) : t_(t), x_(x), area_(t.size()) {
    area_[0].setZero();
    for (std::size_t i = 1; i < t.size(); ++i)
      area_[i] = area_[i - 1] + (t[i] - t[i - 1]) / 2 * (x[i] + x[i - 1]);
  }
  Vec6 mean(double from, double to) const { return (integral(to) - integral(from)) / (to - from); }

 private:
  Vec6 integral(double t) const {
    if (t <= t_.front()) return t * x_.front();
    if (t >= t_.back()) return area_.back() + (t - t_.back()) * x_.back();
    const auto i =
        static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t) - t_.begin() - 1);
    const double s = t - t_[i];
    const Vec6 slope = (x_[i + 1] - x_[i]) / (t_[i + 1] - t_[i]);
    return area_[i] + s * (x_[i] + s / 2 * slope);
  }
  const std::vector<double>& t_;
  const Points& x_;
  Points area_;
};

Points smooth(const Recording& recording, const Points& recorded) {
  const Polyline line(recording.t, recorded);
  const auto n = static_cast<std::size_t>(std::ceil(recording.t.back() / kControlStep)) + 1;
  Points control(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) * kControlStep;
    control[k] = line.mean(t - kControlStep, t + kControlStep);
  }
  return control;
}

struct SplineSample {
  Vec6 x;
  Vec6 rate;  // per second, or per unit of the parameter
};

// Uniform cubic B-spline with its ends held; `at` in control steps from the first point.
SplineSample spline(const Points& control, double at, double step) noexcept {
  const auto last = static_cast<std::ptrdiff_t>(control.size()) - 1;
  const double cell = std::floor(std::clamp(at, -2.0, static_cast<double>(last) + 2));
  const double s = std::clamp(at - cell, 0.0, 1.0), r = 1 - s;
  const auto point = [&](std::ptrdiff_t i) -> const Vec6& {
    const auto k = static_cast<std::ptrdiff_t>(cell) + i;
    return control[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  const Vec6 &a = point(-1), &b = point(0), &c = point(1), &d = point(2);
  const double s2 = s * s, r2 = r * r;
  return {
      (r2 * r * a + (4 - 6 * s2 + 3 * s2 * s) * b + (4 - 6 * r2 + 3 * r2 * r) * c + s2 * s * d) / 6,
      (r2 * (b - a) + (1 + 2 * s * r) * (c - b) + s2 * (d - c)) / (2 * step)};
}

// ---- place and size

// Moves the middle of the box around the path to zero and scales it; returns the scale.
double fit_reach(Points& control, const TraceConfig& config) {
  Vec3 low = control.front().head<3>(), high = low;
  for (const Vec6& x : control) {
    low = low.cwiseMin(x.head<3>());
    high = high.cwiseMax(x.head<3>());
  }
  const Vec3 centre = (low + high) / 2;
  double largest = 0;
  for (Vec6& x : control) {
    x.head<3>() -= centre;
    largest = std::max(largest, x.head<3>().norm());
  }
  const double fits = largest > 0 ? config.reach / largest : INFINITY;
  if (config.scale > fits)
    throw std::runtime_error(config.file + ": scaled by " + std::to_string(config.scale) +
                             " the motion leaves its reach of " + std::to_string(config.reach) +
                             " m; the largest scale that fits is " + std::to_string(fits));
  const double scale = config.scale > 0 ? config.scale : std::min(1.0, fits);
  for (Vec6& x : control) x.head<3>() *= scale;
  return scale;
}

// ---- timing

// How fast each step of the path may be played: the limits, eased by the smallest value nearby and
// then the mean over the same neighbourhood, which never exceeds what any of the steps allows.
std::vector<double> playing_rates(const Points& control, const SpeedLimits& limits) {
  const auto n = static_cast<std::ptrdiff_t>(control.size()) - 1;
  std::vector<double> allowed(static_cast<std::size_t>(n), 1.0), least = allowed, eased = allowed;
  for (std::size_t k = 0; k < allowed.size(); ++k) {
    const Vec6 rate = (control[k + 1] - control[k]) / kControlStep;
    const double excess =
        std::max(rate.head<3>().norm() / limits.speed, rate.tail<3>().norm() / limits.turn_rate);
    allowed[k] = 1 / std::max(1.0, excess);
  }
  const auto near = [n](const std::vector<double>& x, std::ptrdiff_t k, auto&& fold, double value,
                        std::ptrdiff_t reach) {
    for (auto i = k - reach; i <= k + reach; ++i)
      value = fold(value, x[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, n - 1))]);
    return value;
  };
  const auto smaller = [](double a, double b) { return std::min(a, b); };
  for (std::ptrdiff_t k = 0; k < n; ++k)
    least[static_cast<std::size_t>(k)] = near(allowed, k, smaller, 1, kEaseSteps + 1);
  for (std::ptrdiff_t k = 0; k < n; ++k)
    eased[static_cast<std::size_t>(k)] =
        near(least, k, std::plus<>(), 0, kEaseSteps) / (2 * kEaseSteps + 1);
  return eased;
}

// Time at which each control point of the path is passed, with a steady start and stop.
std::vector<double> passing_times(const std::vector<double>& rates) {
  std::vector<double> times(rates.size() + 1, 0);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const double to_end =
        (static_cast<double>(std::min(k, rates.size() - 1 - k)) + 0.5) * kControlStep;
    const double rate = std::min(rates[k], std::sqrt(2 * to_end / kRampTime));
    times[k + 1] = times[k] + kControlStep / rate;
  }
  return times;
}

double lead_time(const Vec6& x, const SpeedLimits& limits) {
  return std::max({kShortestLead, kMinimumJerkPeak * x.head<3>().norm() / limits.speed,
                   kMinimumJerkPeak * x.tail<3>().norm() / limits.turn_rate});
}

// Plays the path by its passing times, led in from the centre before and out to it after.
Points play(const Points& path, const std::vector<double>& times, const SpeedLimits& limits) {
  const double last = static_cast<double>(path.size() - 1);
  const double in = lead_time(spline(path, 0, 1).x, limits);
  const double out = lead_time(spline(path, last, 1).x, limits);
  const double total = in + times.back() + out;
  Points played(static_cast<std::size_t>(std::ceil(total / kControlStep)) + 1);
  std::size_t k = 0;
  for (std::size_t j = 0; j < played.size(); ++j) {
    const double t = static_cast<double>(j) * kControlStep - in;
    while (k + 2 < times.size() && times[k + 1] <= t) ++k;
    const double along = std::clamp((t - times[k]) / (times[k + 1] - times[k]), 0.0, 1.0);
    const double presence = minimum_jerk((t + in) / in).x * minimum_jerk((total - in - t) / out).x;
    played[j] = presence * spline(path, static_cast<double>(k) + along, 1).x;
  }
  return played;
}

}  // namespace

Trace::Trace(const Recording& recording, const TraceConfig& config, const SpeedLimits& limits) {
  Points path = smooth(recording, recorded_points(recording, config));
  report_.rows = recording.t.size();
  report_.recorded = recording.t.back();
  for (std::size_t i = 1; i < recording.t.size(); ++i)
    report_.largest_gap = std::max(report_.largest_gap, recording.t[i] - recording.t[i - 1]);
  report_.scale = fit_reach(path, config);

  const std::vector<double> rates = playing_rates(path, limits);
  for (const double rate : rates) {
    report_.slowest_rate = std::min(report_.slowest_rate, rate);
    if (rate < 1) report_.slowed += kControlStep;
  }
  control_ = play(path, passing_times(rates), limits);
  report_.duration = static_cast<double>(control_.size() + 1) * kControlStep;
}

MotionSample Trace::at(double t) const noexcept {
  const SplineSample s = spline(control_, t / kControlStep - 1, kControlStep);
  return {s.x.head<3>(), s.rate.head<3>(), s.x.tail<3>(), s.rate.tail<3>()};
}

}  // namespace farhand
