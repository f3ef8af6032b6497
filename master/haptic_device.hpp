// The seam between the master and whatever the hand holds, hardware or simulated.
//
// A new device is one struct with what the concept asks for and one entry in the variant of
// devices. What it owes its caller:
//   - read() and write() never block, allocate, throw, log or read a clock; `now` is the only time.
//   - read() answers with the newest complete sample. With none, ok is false and the rest is
//     meaningless; the caller then releases the motors.
//   - theta are joint angles in the geometry's own zero and sense: counts, gears and offsets stay
//     inside the device.
//   - A button it does not have reads as released, a force sensor it does not have as has_force
//     false.
//   - Of an AHRS on its grip at most one sample comes with a reading, in order.
//   - write() holds the torques until the next write. It does not limit them for the user's safety
//     (the caller did), only to what its motors can give, scaling the whole vector.
#pragma once

#include <concepts>

#include "common/geometry.hpp"
#include "common/time.hpp"
#include "master/ahrs/sample.hpp"
#include "master/twin_delta.hpp"

namespace farhand {

struct HandleReading {
  bool ok = false;
  Vec6 theta = Vec6::Zero();  // motor joint angles [rad]; a Falcon uses the first three, rest 0
  bool dead_man = false;      // pressed: the user wants motion and force
  bool clutch = false;        // pressed: the robot rests while the handle is moved back
  bool has_force = false;
  // As the sensors at the two ends of a twin delta's grip read them: user on handle, each sensor's
  // bias and the grip's weight included.
  EndForces ends{};
  std::optional<AhrsSample> ahrs{};  // of an AHRS on the grip, if one came
};

template <typename Device>
concept HapticDevice = requires(Device device, TimePoint now, const Vec6& tau) {
  { Device::kReal } -> std::convertible_to<bool>;  // hardware, not simulated
  { device.read(now) }
  noexcept->std::same_as<HandleReading>;
  // tau: motor torques [N m] at the joints, in the sense of theta.
  { device.write(now, tau) }
  noexcept->std::same_as<void>;
};

}  // namespace farhand
