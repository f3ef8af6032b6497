#include "master/force_law.hpp"

#include <cmath>

namespace farhand {

Wrench motor_wrench(const Wrench& K, const Wrench& F_u, const Wrench& F_e) noexcept {
  return {.force = K.force.cwiseProduct(F_u.force - F_e.force) - F_e.force,
          .torque = K.torque.cwiseProduct(F_u.torque - F_e.torque) - F_e.torque};
}

Vec6 motor_torque(const TwinDeltaJacobian& J, const Wrench& K, const Wrench& F_u,
                  const Wrench& F_e) noexcept {
  return torque(J, motor_wrench(K, F_u, F_e));
}

Vec3 motor_torque(const FalconJacobian& J, const Wrench& K, const Wrench& F_u,
                  const Wrench& F_e) noexcept {
  return torque(J, motor_wrench(K, F_u, F_e).force);
}

AxisResponse axis_response(const AxisLoop& p, double omega) noexcept {
  using Complex = std::complex<double>;
  if (!std::isfinite(omega)) return {};
  const Complex s(0, omega);
  const auto second_order = [&](double m, double b, double k) { return (m * s + b) * s + k; };

  AxisResponse r;
  r.K = p.kp + p.kd * s + Complex(0, -p.ki / omega);
  r.S = 1.0 / (1.0 + r.K);
  r.reduction = 1 - std::abs(r.S);
  r.Z_h = second_order(p.m_d, p.B_d, p.k_d);
  r.e_over_X = r.S * r.Z_h;
  const Complex Z_u = second_order(p.m_u, p.b_u, p.k_u);
  const double w2 = p.w_r * p.w_r;
  const Complex H_r = w2 / second_order(1, 2 * p.zeta_r * p.w_r, w2);
  const Complex felt = std::exp(-s * p.T_delay) * (p.b_e * s + p.k_e) * H_r;
  r.Z_closed = felt + Z_u + r.e_over_X;
  r.X_over_Fc = 1.0 / r.Z_closed;
  r.Fu_over_Fc = (felt + r.e_over_X) * r.X_over_Fc;
  r.Fe_over_Fc = felt * r.X_over_Fc;

  const bool exists = omega > 0 && std::isfinite(std::abs(r.S)) &&
                      std::isfinite(std::abs(r.Z_closed)) && std::isfinite(std::abs(r.X_over_Fc));
  if (!exists) return {.status = Status::singular};
  r.status = Status::ok;
  return r;
}

}  // namespace farhand
