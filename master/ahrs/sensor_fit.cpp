#include "master/ahrs/sensor_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace farhand {
namespace {

constexpr std::size_t kLeastReadings = 9;
constexpr int kSteps = 20;
constexpr double kLeastInformation = 0.02;  // smallest over largest eigenvalue of the normal matrix

// In units of size: offset, then scale less one.
struct Normal {
  Mat6 A = Mat6::Zero();
  Vec6 b = Vec6::Zero();
  double square = 0;

  void add(const SensorFit& f, const Vec3& reading) noexcept {
    const Vec3 x = f(reading);
    const double length = x.norm();
    Vec6 slope;
    slope.head<3>() = -f.scale.cwiseProduct(x) / length;
    slope.tail<3>() = x.cwiseProduct(reading - f.offset) / length;
    A += slope * slope.transpose();
    b += slope * (1 - length);
    square += (1 - length) * (1 - length);
  }
};

Normal normal(const SensorFit& f, std::span<const Vec3> readings, double size) noexcept {
  Normal n;
  for (const Vec3& r : readings) n.add(f, r / size);
  return n;
}

}  // namespace

std::optional<FittedSensor> fit_sensor(std::span<const Vec3> readings, double size) {
  if (readings.size() < kLeastReadings) return {};
  SensorFit f;
  for (int i = 0; i < kSteps; ++i) {
    const Normal n = normal(f, readings, size);
    const Vec6 step = n.A.ldlt().solve(n.b);
    if (!step.allFinite()) return {};
    f.offset += step.head<3>();
    f.scale += step.tail<3>();
  }
  const Normal n = normal(f, readings, size);
  const Vec6 spread = Eigen::SelfAdjointEigenSolver<Mat6>(n.A).eigenvalues();
  if (!(spread[0] > kLeastInformation * spread[5])) return {};
  f.offset *= size;
  return FittedSensor{f, size * std::sqrt(n.square / static_cast<double>(readings.size()))};
}

}  // namespace farhand
