#include "master/build_ahrs.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/scene_values.hpp"

namespace farhand {
namespace {

// Axes of the sensor in the grip's: roll about x, then pitch about y, then yaw about z.
Mat3 sensor_axes(const proto::Ahrs& a) {
  const Vec3 angles = vec3(a.sensor_roll_pitch_yaw_deg()) * radians(1);
  return rotation(angles.z() * Vec3::UnitZ()) * rotation(angles.y() * Vec3::UnitY()) *
         rotation(angles.x() * Vec3::UnitX());
}

Vec3 up_M(const proto::Ahrs& a) {
  return a.up_in_master_size() == 3 ? vec3(a.up_in_master()).normalized() : Vec3(Vec3::UnitY());
}

template <typename Scale>
SensorFit fit(const Vec3& offset, const Scale& scale) {
  return {.offset = offset, .scale = scale.size() == 3 ? vec3(scale) : Vec3(Vec3::Ones())};
}

AhrsFormat format(proto::AhrsSerial::Format f) noexcept {
  switch (f) {
    case proto::AhrsSerial::VECTORNAV:
      return AhrsFormat::vectornav;
    case proto::AhrsSerial::TEXT:
      return AhrsFormat::text;
    case proto::AhrsSerial::NATIVE:
      break;
  }
  return AhrsFormat::native;
}

}  // namespace

GripMotionConfig grip_motion_config(const proto::Ahrs& a, double Ts) {
  constexpr double kTeslaPerMicrotesla = 1e-6;
  GripMotionConfig c{
      .acceleration = fit(vec3(a.accelerometer().offset_m_per_s2()), a.accelerometer().scale()),
      .magnetic = fit(kTeslaPerMicrotesla * vec3(a.magnetometer().offset_microtesla()),
                      a.magnetometer().scale()),
      .R_HI = sensor_axes(a),
      .p_HI = vec3(a.sensor_position_m()),
      .latency = milliseconds(a.latency_ms()),
      .period = from_seconds(1 / a.rate_hz())};
  c.observer.Ts = Ts;
  c.attitude.up_M = up_M(a);
  return c;
}

SimAhrsConfig sim_ahrs_config(const proto::Ahrs& a) {
  return {.rate = a.rate_hz(),
          .latency = milliseconds(a.latency_ms()),
          .magnetometer = a.simulated().magnetometer(),
          .up_M = up_M(a),
          .R_HI = sensor_axes(a),
          .p_HI = vec3(a.sensor_position_m())};
}

void open_ahrs(const proto::Scene& scene, std::optional<AhrsLine>& line) {
  const proto::Ahrs& a = scene.master().ahrs();
  if (!a.has_serial()) return;
  line.emplace(a.serial().path(), static_cast<unsigned>(a.serial().baud()),
               format(a.serial().format()));
}

std::string ahrs_stage(const proto::Ahrs& a) {
  const std::string source =
      a.has_serial() ? a.serial().path()
                     : std::string(a.simulated().magnetometer() ? "simulated, with magnetometer"
                                                                : "simulated");
  return fmt::format("ahrs              {} at {:g} Hz: the handle's orientation and velocity",
                     source, a.rate_hz());
}

}  // namespace farhand
