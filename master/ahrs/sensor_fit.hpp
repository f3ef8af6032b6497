// Offset and scale of a sensor from what it reads at rest in many orientations: an accelerometer
// there reads gravity, a magnetometer the field, whatever way it is turned.
#pragma once

#include <optional>
#include <span>

#include "master/ahrs/sample.hpp"

namespace farhand {

struct FittedSensor {
  SensorFit fit;
  double residual = 0;  // root mean square of | |corrected| - size |, in the sensor's unit
};

// Readings [any unit], each the mean of a rest; size: what their length ought to be, same unit.
// Least squares by Gauss and Newton on the six numbers. Nothing when the orientations do not tell
// them: fewer than nine, or too much alike.
std::optional<FittedSensor> fit_sensor(std::span<const Vec3> readings, double size);

}  // namespace farhand
