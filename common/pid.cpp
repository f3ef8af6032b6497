#include "common/pid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace farhand {
namespace {

// The integral may grow for weeks by steps far below its last digit. One senseless sample must not
// leave it where it would take weeks to come back from.
void add(PidState& s, double dI, double limit) noexcept {
  const double rest = dI - s.I_lost, sum = s.I + rest;
  s.I_lost = std::abs(sum) < limit ? (sum - s.I) - rest : 0;
  s.I = std::clamp(sum, -limit, limit);
}

}  // namespace

double low_pass_gain(double cutoff_hz, double Ts) noexcept {
  return cutoff_hz > 0 ? -std::expm1(-2 * std::numbers::pi * cutoff_hz * Ts) : 1.0;
}

Pid make_pid(const PidConfig& c, double Ts) noexcept {
  return {.kp = c.kp,
          .half_ki_Ts = c.ki * Ts / 2,
          .kd_per_Ts = c.kd / Ts,
          .limit = c.limit,
          .derivative_gain = low_pass_gain(c.derivative_cutoff_hz, Ts),
          .derivative_on_measurement = c.derivative_on_measurement};
}

double step(const Pid& pid, PidState& s, double r, double y, double feedforward) noexcept {
  const double e = r - y;
  const double e_last = s.primed ? s.e : e, y_last = s.primed ? s.y : y;
  const double slope = pid.derivative_on_measurement ? y_last - y : e - e_last;
  const double D = s.D + pid.derivative_gain * (pid.kd_per_Ts * slope - s.D);
  const double dI = pid.half_ki_Ts * (e + e_last);
  const double raw = pid.kp * e + (s.I + dI) + D + feedforward;
  if (!std::isfinite(raw)) {  // so it is if any input is not
    s.primed = false;
    return 0;
  }

  s.saturated = std::abs(raw) > pid.limit;
  if (!((raw > pid.limit && dI > 0) || (raw < -pid.limit && dI < 0))) add(s, dI, pid.limit);
  s.primed = true;
  s.e = e;
  s.y = y;
  s.D = D;
  return std::clamp(pid.kp * e + s.I + D + feedforward, -pid.limit, pid.limit);
}

IncrementalPid make_incremental_pid(const PidConfig& g, double Ts) noexcept {
  return {.a = g.kp + g.ki * Ts / 2 + g.kd / Ts,
          .b = -g.kp + g.ki * Ts / 2 - 2 * g.kd / Ts,
          .c = g.kd / Ts};
}

void start(IncrementalPid& pid, const PidConfig& config, double e0) noexcept {
  pid.e1 = pid.e2 = e0;
  pid.u = config.kp * e0;
}

double step(IncrementalPid& pid, double e) noexcept {
  pid.u += pid.a * e + pid.b * pid.e1 + pid.c * pid.e2;
  pid.e2 = pid.e1;
  pid.e1 = e;
  return pid.u;
}

}  // namespace farhand
