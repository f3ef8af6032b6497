#include "common/clock_sync.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

double nanoseconds(Duration d) noexcept {
  return static_cast<double>(d.count());
}
Duration rounded(double nanoseconds) noexcept {
  return Duration(std::llround(nanoseconds));
}

}  // namespace

void ClockSync::Floors::lower(const Floors& other) noexcept {
  if (other.empty) return;
  if (empty) {
    *this = other;
    return;
  }
  since = std::min(since, other.since);
  forward = std::min(forward, other.forward);
  backward = std::min(backward, other.backward);
  round_trip = std::min(round_trip, other.round_trip);
}

Duration ClockSync::at_origin(const Sample& s, double sign) const noexcept {
  return s.value + rounded(sign * drift_ * nanoseconds(origin_ - s.at));
}

ClockSync::Floors ClockSync::floors(const Grain& g) const noexcept {
  return {.empty = false,
          .since = std::min(g.forward.at, g.backward.at),
          .forward = at_origin(g.forward, 1),
          .backward = at_origin(g.backward, -1),
          .round_trip = g.round_trip};
}

void ClockSync::add(const Exchange& x) noexcept {
  const Duration hold = x.t3 - x.t2, round_trip = x.t4 - x.t1 - hold;
  if (hold < Duration::zero() || round_trip < Duration::zero()) return;
  const std::int64_t number = x.t4 / kGrain;
  const Sample forward{x.t4, x.t2 - x.t1}, backward{x.t4, x.t4 - x.t3};
  if (has_open_ && number > open_.number) close(number);
  last_ = has_open_ ? std::max(last_, x.t4) : x.t4;
  if (!has_open_) {
    has_open_ = true;
    origin_ = x.t4;
    open_ = {number, forward, backward, round_trip};
    return;
  }
  if (at_origin(forward, 1) < at_origin(open_.forward, 1)) open_.forward = forward;
  if (at_origin(backward, -1) < at_origin(open_.backward, -1)) open_.backward = backward;
  open_.round_trip = std::min(open_.round_trip, round_trip);
}

void ClockSync::close(std::int64_t next) noexcept {
  has_open_ = false;
  append(open_);
  while (size_ > 0 && closed(0).number + std::int64_t{kHistory} <= next) {
    first_ = (first_ + 1) % kHistory;
    --size_;
  }
  fit();
  origin_ = next * kGrain;
  window_ = {};
  bool any_steady = false;
  for (std::size_t i = 0; i < size_; ++i) {
    const Grain& g = closed(i);
    if (g.number + kWindow / kGrain <= next) continue;
    window_.lower(floors(g));
    any_steady = any_steady || g.steady;
  }
  if (!any_steady) forget();
}

// The grain in which a step fell has fast ones of before and of after, so it goes too.
void ClockSync::append(Grain grain) noexcept {
  const Floors now = floors(grain);
  if (fitted_ && !window_.empty) {
    const double drifted = drift_uncertainty_ * nanoseconds(now.since - window_.since);
    const Duration least = 8 * spread_ + rounded(std::max(drifted, 0.0)) + kFinest;
    const Duration there = now.forward - window_.forward, back = now.backward - window_.backward;
    if (std::min(there, back) < -least) return forget();
    grain.steady = std::max(there, back) <= least;
  }
  ring_[(first_ + size_++) % kHistory] = grain;
}

void ClockSync::forget() noexcept {
  size_ = 0;
  window_ = {};
  fitted_ = false;
  drift_ = 0;
  drift_uncertainty_ = kUsualDrift;
}

void ClockSync::fit() noexcept {
  double n = 0, t = 0, y = 0, tt = 0, ty = 0, yy = 0;  // running means, and sums about them [ns]
  for (std::size_t i = 0; i < size_; ++i) {
    const Grain& g = closed(i);
    if (!g.steady) continue;
    const double dt = nanoseconds(g.middle() - closed(0).middle()) - t;
    const double dy = nanoseconds(g.offset() - closed(0).offset()) - y;
    ++n;
    t += dt / n;
    y += dy / n;
    const double weight = (n - 1) / n;
    tt += weight * dt * dt;
    ty += weight * dt * dy;
    yy += weight * dy * dy;
  }
  if (n < kFewest) return;
  const double slope = ty / tt, variance = std::max(yy - slope * ty, 0.0) / (n - 2);
  if (std::abs(slope) > kLargestDrift) return forget();
  const double s2 = variance / tt;
  const double stands_out = std::max(1 - kShrink * s2 / (slope * slope), 0.0);
  drift_ = slope == 0 ? 0 : slope * stands_out / (1 + s2 / (kUsualDrift * kUsualDrift));
  drift_uncertainty_ = std::min(kUsualDrift, 3 * std::sqrt(s2) + std::abs(slope - drift_));
  spread_ = rounded(std::sqrt(variance));
  fitted_ = true;
}

ClockSync::Floors ClockSync::floors() const noexcept {
  Floors all = window_;
  if (has_open_) all.lower(floors(open_));
  return all;
}

Duration ClockSync::lateness(const Exchange& x) const noexcept {
  const Floors all = floors();
  if (all.empty) return Duration::zero();
  const Duration back = at_origin({x.t4, x.t4 - x.t3}, -1) - all.backward;
  const Duration round_trip = x.t4 - x.t1 - (x.t3 - x.t2) - all.round_trip;
  return std::min(back, round_trip);
}

ClockEstimate ClockSync::estimate() const noexcept {
  const Floors all = floors();
  if (all.empty) return {};
  const double ahead = drift_ * nanoseconds(last_ - origin_);
  const double aged = drift_uncertainty_ * nanoseconds(last_ - all.since);
  return {.valid = true,
          .offset = (all.forward - all.backward) / 2 + rounded(ahead),
          .round_trip = all.round_trip,
          .uncertainty = all.round_trip / 2 + rounded(aged),
          .drift = drift_,
          .drift_uncertainty = drift_uncertainty_};
}

}  // namespace farhand
