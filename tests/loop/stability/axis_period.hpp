// One axis over one period, linear and exact in time, from the master's sample to its next:
//
//   sample    the handle's place x(k) and the sensor's force F_u(k)
//   slave     its tick on x(k), as soon as the message is there; with it the arm's next period
//   answer    at to_slave + to_master after the sample if that is within cut_off: then the master
//             acts there on the force of this very period. Later: at cut_off on the newest one
//             there, which is lag() periods old
//   device    up to that instant under the old motor force, from there on under the new one
//
// The slave ticks on arrivals, so its own phase does not matter: only the order of its samples
// does. The hand's and the arm's integration steps are the simulation's own (semi-implicit Euler in
// equal steps within a span; fourth-order Runge-Kutta), so that the two differ by nothing but what
// is not linear.
//
// The device's observers are told the command, whatever the motors then do: opening the loop at the
// motors leaves that inner path closed.
#pragma once

#include <vector>

#include "tests/loop/stability/axis.hpp"

namespace farhand {

// Everything that one period hands to the next.
struct AxisState {
  // Hand and device: place [m], speed [m/s], what the sensor felt in the last step [N], motor force
  // [N].
  double x = 0, v = 0, F_u = 0, motor = 0;
  // Force controller: filtered force, and its PID.
  double filtered = 0, I = 0, e = 0, D = 0;
  std::optional<AxisDeviceState> device;
  // Arm and servo.
  Vec6 q = Vec6::Zero(), dq = Vec6::Zero();
  Vec6 servo_I = Vec6::Zero(), servo_D = Vec6::Zero(), last_q = Vec6::Zero();
  double command = 0, command_rate = 0;  // of the tool along the axis [m, m/s]
  double sensed = 0;                     // robot on wall, through the sensor's filter [N]
  Eigen::VectorXd answers;               // forces under way, the newest first [N]
};

class AxisPeriod {
 public:
  explicit AxisPeriod(const AxisModel& model);

  // Answers are used this many periods after the sample they answer.
  int lag() const noexcept { return lag_; }
  AxisState rest() const;

  // One period. Returns the motor force the controller asks for; the motors get `instead` if given,
  // which opens the loop.
  double run(AxisState& state, std::optional<double> instead = {}) const;

 private:
  using Mat12 = Eigen::Matrix<double, 12, 12>;
  // The hand's steps within a span are alike.
  struct Steps {
    long count = 0;
    double h = 0;
  };

  double slave_tick(AxisState& state) const;
  double command(AxisState& state, double F_e, double F_u, double x) const;
  double force_loop(AxisState& state, double F_d, double F_u) const;
  void hand(AxisState& state, const std::vector<Steps>& span) const;
  std::vector<Steps> steps(Duration span) const;

  AxisModel model_;
  std::optional<AxisDeviceStages> device_;
  int lag_ = 0;
  std::vector<Steps> before_, after_;      // the master acts
  Mat12 arm_;                              // (q, dq) over a period
  Eigen::Matrix<double, 12, 6> torque_;    // a held torque's share
  Vec6 kp_, half_ki_Ts_, kd_, kd_per_Ts_;  // of the servo
  double servo_derivative_gain_, command_gain_, sensing_gain_, force_gain_ = 1,
                                                               force_derivative_gain_ = 1;
};

}  // namespace farhand
