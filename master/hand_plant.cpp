#include "master/hand_plant.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

constexpr double kSlipSpeed = 0.005;  // [m/s] where friction is near its full size
constexpr double kSlipRate = 0.05;    // [rad/s]

// Friction as a damper: its size over the speed, which at rest is a finite limit.
double friction_damping(double friction, double speed, double slip) noexcept {
  const double s = speed / slip;
  return friction / slip * (s > 1e-4 ? std::tanh(s) / s : 1.0);
}

void move(const Plant& plant, HandState& s, const Course<Vec3>& wish, const Vec3& motor,
          const Vec3& push, double h, Vec3& user) noexcept {
  const PlantConfig& device = plant.device;
  const HandImpedance& hand = plant.hand;
  const double mass = device.mass + hand.mass;
  const double brake =
      device.damping + friction_damping(device.friction, s.v_MH.norm(), kSlipSpeed);
  const Vec3 spring = hand.stiffness * (wish.x - s.p_MH) + hand.damping * wish.rate + push;
  const Vec3 load = spring + device.weight * plant.down_M + motor;
  const Vec3 v = (mass * s.v_MH + h * load) / (mass + h * (brake + hand.damping));
  user = spring - hand.damping * v - hand.mass / h * (v - s.v_MH);
  s.v_MH = v;
  s.p_MH += h * v;
}

void tilt(const Plant& plant, HandState& s, const Course<Vec3>& wish, const Vec3& motor, double h,
          Vec3& user) noexcept {
  const PlantConfig& device = plant.device;
  const HandImpedance& hand = plant.hand;
  const double brake = device.rotation_damping +
                       friction_damping(device.rotation_friction, s.omega_M.norm(), kSlipRate);
  const Vec3 spring =
      s.axis_M.cross(hand.rotation_stiffness * wish.x + hand.rotation_damping * wish.rate);
  const Vec3 omega = (device.rotation_inertia * s.omega_M + h * (spring + motor)) /
                     (device.rotation_inertia + h * (brake + hand.rotation_damping));
  user = spring - hand.rotation_damping * omega;
  s.axis_M = (s.axis_M + h * omega.cross(s.axis_M)).normalized();
  s.omega_M = omega - s.axis_M.dot(omega) * s.axis_M;
}

void twist(const Plant& plant, HandState& s, const Course<double>& wish, double motor, double h,
           double& user) noexcept {
  const PlantConfig& device = plant.device;
  const HandImpedance& hand = plant.hand;
  const double spring = hand.twist_stiffness * (wish.x - s.twist) + hand.twist_damping * wish.rate;
  const double rate = (device.twist_inertia * s.twist_rate + h * (spring + motor)) /
                      (device.twist_inertia + h * (device.twist_damping + hand.twist_damping));
  user = spring - hand.twist_damping * rate;
  s.twist_rate = rate;
  s.twist += h * rate;
}

}  // namespace

HandLoad step(const Plant& plant, HandState& state, const HandCourse& wish, const HandLoad& motors,
              const Vec3& push, double h) noexcept {
  HandLoad user;
  move(plant, state, wish.p, motors.force, push, h, user.force);
  if (!plant.rotates) return user;
  tilt(plant, state, wish.axis, motors.moment, h, user.moment);
  twist(plant, state, wish.twist, motors.twist, h, user.twist);
  return user;
}

double fastest(const Plant& plant) noexcept {
  const PlantConfig& device = plant.device;
  const HandImpedance& hand = plant.hand;
  double most = hand.stiffness / (device.mass + hand.mass);
  if (plant.rotates)
    most = std::max({most, hand.rotation_stiffness / device.rotation_inertia,
                     hand.twist_stiffness / device.twist_inertia});
  return std::sqrt(most);
}

double energy(const Plant& plant, const HandState& s) noexcept {
  const PlantConfig& device = plant.device;
  return ((device.mass + plant.hand.mass) * s.v_MH.squaredNorm() +
          device.rotation_inertia * s.omega_M.squaredNorm() +
          device.twist_inertia * s.twist_rate * s.twist_rate) /
             2 -
         device.weight * plant.down_M.dot(s.p_MH);
}

}  // namespace farhand
