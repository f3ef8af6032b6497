// The stages of the master's force controller that know the device's model, on one axis and linear:
// no friction in the device and none in the model, weight carried. The equations are those of
// master/device_observer.hpp and master/force_controller.hpp.
#pragma once

#include <optional>

#include "master/force_controller.hpp"

namespace farhand {

struct AxisDevice {
  double mass = 1, damping = 0;  // of the model [kg, N s/m]
  DeviceObserverConfig observer;
  int motor_delay = 0;               // [periods], as the controller believes it
  bool senses_user = true;           // false: what is not explained is the user
  double fed_damping = 0;            // by the motors in the device's place [N s/m]
  double fed_inertia = 0;            // [kg]
  double contact_damping = 0;        // as in firm contact: all of it, always [N s/m]
  double disturbance_share = 0;      // of what is not explained, taken away
  double disturbance_cutoff_hz = 0;  // of its pole; 0: none
};

// Without `device` in the configuration: none. has_sensor: of the user's force.
std::optional<AxisDevice> axis_device(const ForceControllerConfig& config, bool has_sensor);

// What the stages hand to the next period.
struct AxisDeviceState {
  double x = 0;                            // measured last [m]
  double off_model = 0, v = 0, rest = 0;   // of the observer on the model [m, m/s, N]
  double off_pose = 0, v_pose = 0, a = 0;  // of the one on the pose [m, m/s, m/s^2]
  double disturbance = 0;                  // rest through its pole [N]
  Eigen::VectorXd given;                   // commands, the newest first [N]
};

class AxisDeviceStages {
 public:
  AxisDeviceStages(const AxisDevice& device, double Ts) noexcept;

  AxisDeviceState rest() const;
  // The handle is measured at x, the user with F_u. Returns the user's force as the force loop is
  // told it: F_u, or the estimate.
  double observe(AxisDeviceState& s, double x, double F_u) const noexcept;
  // What raises the environment's force.
  double damping(const AxisDeviceState& s) const noexcept { return device_.contact_damping * s.v; }
  // What the motors give beside it and the force loop.
  double load(const AxisDeviceState& s) const noexcept;
  void remember(AxisDeviceState& s, double command) const noexcept;

 private:
  AxisDevice device_;
  double Ts_, disturbance_gain_;
  ObserverGains on_model_, on_pose_;
};

}  // namespace farhand
