#include "master/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace farhand {
namespace {

constexpr double kCorner = 0.1;      // [s] each side of the corner of min(1, t)
constexpr double kFade = 1;          // [s]
constexpr double kLeastShare = 0.1;  // of a limit, left for a trace

Vec6 amplitude(const Sine& s) noexcept {
  return (Vec6() << s.offset, s.turn).finished();
}
Vec6 offset(const Reach& r) noexcept {
  return (Vec6() << r.by, r.turn).finished();
}

Progress fade_in(double t) noexcept {
  if (t <= 1 - kCorner) return {t, 1};
  if (t >= 1 + kCorner) return {1, 0};
  const double rest = 1 + kCorner - t;
  return {1 - rest * rest / (4 * kCorner), rest / (2 * kCorner)};
}

Progress fade_out(double left) noexcept {
  const double s = std::min(left / kFade, 1.0);
  return {s * s * (3 - 2 * s), -6 * s * (1 - s) / kFade};
}

Progress sine_at(const Sine& s, double t) noexcept {
  if (t <= s.from || t >= s.until) return {};
  const double w = 2 * std::numbers::pi * s.frequency, phase = w * (t - s.from);
  const Progress in = fade_in(t - s.from), out = fade_out(s.until - t);
  const double swing = std::sin(phase);
  return {swing * in.x * out.x,
          w * std::cos(phase) * in.x * out.x + swing * in.rate * out.x + swing * in.x * out.rate};
}

Progress reach_at(const Reach& r, double t) noexcept {
  const Progress s = minimum_jerk((t - r.at) / r.lasting);
  return {s.x, s.rate / r.lasting};
}

// ---- the fastest the sines and reaches can be

struct Span {
  double from = 0, until = 0;
  Vec6 peak = Vec6::Zero();  // of the rate's magnitude, axis by axis
};

// Of the rate of a sine of amplitude 1: sqrt(w^2 e^2 + e'^2) over the fades e (slopes up to 1 and
// 1.5) stays below w when w^2 >= 6; when the fades overlap their slopes simply add.
double peak_rate(const Sine& s) noexcept {
  const double w = 2 * std::numbers::pi * s.frequency;
  if (s.until - s.from < 1 + kCorner + kFade) return w + 2.5;
  return w * w >= 6 ? w : std::hypot(w, 1.5);
}

std::vector<Span> spans(const MotionConfig& c) {
  std::vector<Span> out;
  for (const Sine& s : c.sines)
    out.push_back({s.from, s.until, amplitude(s).cwiseAbs() * peak_rate(s)});
  for (const Reach& r : c.reaches)
    out.push_back({r.at, r.at + r.lasting, offset(r).cwiseAbs() * (kMinimumJerkPeak / r.lasting)});
  return out;
}

struct Peak {
  double speed = 0, speed_at = 0;
  double turn_rate = 0, turn_rate_at = 0;
};

// The worst sum of spans; a sum is largest where one of its spans begins.
Peak peak_of(const MotionConfig& c) {
  const std::vector<Span> all = spans(c);
  Peak peak;
  for (const Span& begin : all) {
    Vec6 sum = Vec6::Zero();
    for (const Span& s : all)
      if (s.from <= begin.from && begin.from < s.until) sum += s.peak;
    const double speed = sum.head<3>().norm(), turn_rate = sum.tail<3>().norm();
    if (speed > peak.speed) peak.speed = speed, peak.speed_at = begin.from;
    if (turn_rate > peak.turn_rate) peak.turn_rate = turn_rate, peak.turn_rate_at = begin.from;
  }
  return peak;
}

void refuse_beyond(double peak, double at, double limit, const char* what, const char* unit) {
  if (peak <= limit) return;
  throw std::runtime_error(std::string("the wished motion may ") + what + " with " +
                           std::to_string(peak) + " " + unit + " from " + std::to_string(at) +
                           " s on, beyond its limit of " + std::to_string(limit) +
                           "; lower an amplitude or a frequency, lengthen a reach, or raise the "
                           "limit");
}

SpeedLimits left_by(const Peak& peak, const SpeedLimits& limits) {
  const SpeedLimits left{limits.speed - peak.speed, limits.turn_rate - peak.turn_rate};
  if (left.speed < kLeastShare * limits.speed || left.turn_rate < kLeastShare * limits.turn_rate)
    throw std::runtime_error(
        "the sines and reaches leave the trace less than a tenth of the speed "
        "limits; leave them out or make them slower");
  return left;
}

}  // namespace

Motion::Motion(MotionConfig config) : config_(std::move(config)) {
  const Peak peak = peak_of(config_);
  const SpeedLimits& limits = config_.limits;
  refuse_beyond(peak.speed, peak.speed_at, limits.speed, "move", "m/s");
  refuse_beyond(peak.turn_rate, peak.turn_rate_at, limits.turn_rate, "turn", "rad/s");

  std::stable_sort(config_.reaches.begin(), config_.reaches.end(),
                   [](const Reach& a, const Reach& b) { return a.at < b.at; });
  Done so_far{Vec6::Zero(), 0};
  for (const Reach& r : config_.reaches) {
    so_far.offset += offset(r);
    so_far.end = std::max(so_far.end, r.at + r.lasting);
    done_.push_back(so_far);
  }
  if (config_.trace)
    trace_.emplace(read_recording(config_.trace->file), *config_.trace, left_by(peak, limits));
}

// Back from the last reach that has begun to where everything before has ended.
void Motion::add_reaches(double t, Vec6& x, Vec6& rate) const noexcept {
  const auto& reaches = config_.reaches;
  auto begun = std::upper_bound(reaches.begin(), reaches.end(), t,
                                [](double time, const Reach& r) { return time < r.at; }) -
               reaches.begin();
  for (; begun > 0; --begun) {
    const auto i = static_cast<std::size_t>(begun - 1);
    if (done_[i].end <= t) {
      x += done_[i].offset;
      return;
    }
    const Progress s = reach_at(reaches[i], t);
    const Vec6 by = offset(reaches[i]);
    x += s.x * by;
    rate += s.rate * by;
  }
}

MotionSample Motion::at(double t) const noexcept {
  t = std::max(t, 0.0);
  Vec6 x = Vec6::Zero(), rate = Vec6::Zero();
  for (const Sine& sine : config_.sines) {
    const Progress s = sine_at(sine, t);
    const Vec6 by = amplitude(sine);
    x += s.x * by;
    rate += s.rate * by;
  }
  add_reaches(t, x, rate);
  MotionSample out{x.head<3>(), rate.head<3>(), x.tail<3>(), rate.tail<3>()};
  if (trace_) {
    const MotionSample recorded = trace_->at(t);
    out.p += recorded.p;
    out.v += recorded.v;
    out.turn += recorded.turn;
    out.turn_rate += recorded.turn_rate;
  }
  return out;
}

}  // namespace farhand
