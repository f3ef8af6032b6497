// Discrete PID (Falcon publication eq. 12-15; reference section 4). With e = r - y and sample time
// Ts, the integral by Tustin and the derivative by backward difference:
//
//   I(k) = I(k-1) + ki Ts/2 (e(k) + e(k-1))   summed with its rounding carried along (Kahan)
//   D(k) = kd (e(k) - e(k-1)) / Ts          on the error, or  -kd (y(k) - y(k-1)) / Ts  on the
//   measurement,
//                                           then an optional one-pole low-pass, D += (1 - exp(-2 pi
//                                           fc Ts)) (D_raw - D)
//   u(k) = clamp(kp e(k) + I(k) + D(k) + feedforward, -limit, +limit)
//
// Anti-windup: the increment of I is taken only if it does not push a saturated sum further out,
// and I itself stays within the limit. A fresh state starts without a derivative kick: e(-1) =
// e(0), y(-1) = y(0), I = 0.
#pragma once

#include <limits>

namespace farhand {

// What people set. Units follow from the axis: [u/e], [u/(e s)], [u s/e].
struct PidConfig {
  double kp = 0;
  double ki = 0;
  double kd = 0;
  double limit = std::numeric_limits<double>::infinity();  // on |u|, > 0
  double derivative_cutoff_hz = 0;                         // 0: no filter
  bool derivative_on_measurement = false;                  // no kick when the set-point steps
};

// The same, prepared for one sample time.
struct Pid {
  double kp = 0;
  double half_ki_Ts = 0;
  double kd_per_Ts = 0;
  double limit = std::numeric_limits<double>::infinity();
  double derivative_gain = 1;  // 1: unfiltered
  bool derivative_on_measurement = false;
};

// Ts > 0 [s].
Pid make_pid(const PidConfig& config, double Ts) noexcept;

// Changes each sample; the terms stay here so that a log explains the output.
struct PidState {
  bool primed = false;  // false: the next sample is the first, no kick
  bool saturated = false;
  double e = 0;  // of the last sample
  double y = 0;
  double I = 0;
  double I_lost = 0;  // what rounding took from I
  double D = 0;
};

// One sample: reference r, measurement y, and a feed-forward that shares the output's limit.
// Inputs that are not finite, or so large that a term is not, give 0 and leave I and D as they are;
// the next sample comes without a kick.
double step(const Pid& pid, PidState& state, double r, double y, double feedforward = 0) noexcept;

// The incremental form u(k) = u(k-1) + a e(k) + b e(k-1) + c e(k-2) (eq. 13-15): the same output in
// exact arithmetic while nothing saturates, about 100 times worse in rounding, and not clampable.
// Kept as the tested equivalent.
struct IncrementalPid {
  double a = 0, b = 0, c = 0;
  double u = 0, e1 = 0, e2 = 0;
};
IncrementalPid make_incremental_pid(const PidConfig& config, double Ts) noexcept;
// History without a kick: e(-1) = e(-2) = e0 and u(-1) = kp e0.
void start(IncrementalPid& pid, const PidConfig& config, double e0) noexcept;
double step(IncrementalPid& pid, double e) noexcept;

// Gain of a one-pole low-pass y += gain (x - y) with cut-off fc [Hz] at sample time Ts [s]; fc <=
// 0: 1, no filter.
double low_pass_gain(double cutoff_hz, double Ts) noexcept;

}  // namespace farhand
