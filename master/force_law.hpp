// What the handle's motors do with the user's and the environment's wrench (twin-delta publication
// eq. 39-47 with its errata; reference section 9).
#pragma once

#include <complex>

#include "common/geometry.hpp"
#include "common/status.hpp"
#include "master/falcon.hpp"
#include "master/twin_delta.hpp"

namespace farhand {

// Wrench the motors shall put on the hand,
//
//   F_m = K (F_u - F_e) - F_e
//
// F_u: the user's wrench on the handle; F_e: the robot's wrench on its environment; both in handle
// axes G about H. K: one gain per axis, written in the members of a wrench; the gains act before
// the map to the motors. K = 0 is open-loop force reflection. With the user's own torques the
// motors see (I + K) (F_u - F_e), so F_u = F_e is the equilibrium.
Wrench motor_wrench(const Wrench& K, const Wrench& F_u, const Wrench& F_e) noexcept;

// tau_m = J_h^-T F_m. Zero if J is not ok or a wrench is not finite.
Vec6 motor_torque(const TwinDeltaJacobian& J, const Wrench& K, const Wrench& F_u,
                  const Wrench& F_e) noexcept;
// The same for a handle of forces only, in M axes; the torque members are not looked at.
Vec3 motor_torque(const FalconJacobian& J, const Wrench& K, const Wrench& F_u,
                  const Wrench& F_e) noexcept;

// One axis of the closed loop as transfer functions, for design and checks, not for the loop.
//   K = kp + kd s + ki/s            the force controller
//   Z_h = m_d s^2 + B_d s + k_d     the device        Z_u = m_u s^2 + b_u s + k_u   the user
//   Z_e = b_e s + k_e               the environment
//   H_r = w_r^2 / (s^2 + 2 zeta_r w_r s + w_r^2)      the robot
struct AxisLoop {
  double kp = 0, kd = 0, ki = 0;
  double m_d = 0, B_d = 0, k_d = 0;
  double m_u = 0, b_u = 0, k_u = 0;
  double b_e = 0, k_e = 0;
  double w_r = 0, zeta_r = 0;  // w_r > 0 [rad/s]
  double T_delay = 0;          // round trip [s]
};

// At s = j omega. The environment's force comes back as F_e = exp(-s T) Z_e H_r X, and the hand's
// intended force F_c acts against its own impedance, F_u = F_c - Z_u X.
struct AxisResponse {
  Status status = Status::not_finite;
  std::complex<double> K{}, S{};  // S = 1 / (1 + K)
  double reduction = 0;           // 1 - |S|: how much of the device's own dynamics vanishes
  std::complex<double> Z_h{};
  std::complex<double> e_over_X{};  // (F_u - F_e) / X = S Z_h
  std::complex<double> Z_closed{};  // F_c / X; what eq. 45 calls an impedance is its inverse
  std::complex<double> X_over_Fc{}, Fu_over_Fc{}, Fe_over_Fc{};
};
// omega > 0 [rad/s]; otherwise, or where a pole lies on j omega, singular.
AxisResponse axis_response(const AxisLoop& loop, double omega) noexcept;

}  // namespace farhand
