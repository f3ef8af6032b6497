#include "master/falcon_usb/calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <optional>

namespace farhand::falcon_usb {
namespace {

constexpr int kUnknowns = 5;  // gear ratio, angle offset, origin
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

FalconGeometry with(FalconGeometry g, const Unknowns& x) {
  g.gear_ratio = x[0];
  g.angle_offset = x[1];
  return g;
}

// Forward kinematics less the known places, one below the other; nothing where a pose has no
// answer.
std::optional<Eigen::VectorXd> misfit(const FalconGeometry& start, const Unknowns& x,
                                      std::span<const KnownPose> poses) {
  const FalconGeometry g = with(start, x);
  Eigen::VectorXd out(3 * static_cast<Eigen::Index>(poses.size()));
  Eigen::Index row = 0;
  for (const KnownPose& pose : poses) {
    const Vec3 theta = (theta1_quantum(g) * pose.counts).array() + g.angle_offset;
    const FalconForward at = forward(g, theta);
    if (at.status != Status::ok) return {};
    out.segment<3>(row) = at.p_MH - x.tail<3>() - pose.p;
    row += 3;
  }
  return out;
}

std::optional<Eigen::MatrixXd> slopes(const FalconGeometry& start, const Unknowns& x,
                                      std::span<const KnownPose> poses) {
  constexpr double kStep = 1e-5;
  Eigen::MatrixXd out(3 * static_cast<Eigen::Index>(poses.size()), kUnknowns);
  for (int i = 0; i < kUnknowns; ++i) {
    const auto above = misfit(start, x + kStep * Unknowns::Unit(i), poses);
    const auto below = misfit(start, x - kStep * Unknowns::Unit(i), poses);
    if (!above || !below) return {};
    out.col(i) = (*above - *below) / (2 * kStep);
  }
  return out;
}

// The origin starts where the first pose has it by the numbers given.
std::optional<Unknowns> guess(const FalconGeometry& g, std::span<const KnownPose> poses) {
  Unknowns x;
  x << g.gear_ratio, g.angle_offset, Vec3::Zero();
  const auto first = misfit(g, x, poses);
  if (!first) return {};
  x.tail<3>() = first->head<3>();
  return x;
}

// Gauss-Newton: the problem is nearly linear. Nothing if it leads out of reach or does not settle.
std::optional<Unknowns> search(const FalconGeometry& g, std::span<const KnownPose> poses) {
  constexpr int kMostSteps = 30;
  constexpr double kSettled = 1e-10;
  auto x = guess(g, poses);
  for (int i = 0; x && i < kMostSteps; ++i) {
    const auto e = misfit(g, *x, poses);
    const auto J = slopes(g, *x, poses);
    if (!e || !J) return {};
    const auto solver = J->colPivHouseholderQr();
    if (solver.rank() < kUnknowns) return {};
    const Unknowns step = solver.solve(*e);
    *x -= step;
    if (step.norm() < kSettled) return x;
  }
  return {};
}

}  // namespace

GeometryFit fit_geometry(const FalconGeometry& geometry, std::span<const KnownPose> poses) {
  GeometryFit out{.geometry = geometry};
  if (poses.size() < kFewestPoses) return out;
  const auto x = search(geometry, poses);
  if (!x) return out;
  const Eigen::VectorXd e = *misfit(geometry, *x, poses);
  const Eigen::MatrixXd J = *slopes(geometry, *x, poses);
  const double variance = e.squaredNorm() / static_cast<double>(e.size() - kUnknowns);
  const Eigen::MatrixXd covariance = variance * (J.transpose() * J).inverse();
  out.good = covariance.allFinite();
  out.geometry = with(geometry, *x);
  out.origin_M = x->tail<3>();
  out.gear_ratio_sd = std::sqrt(covariance(0, 0));
  out.angle_offset_sd = std::sqrt(covariance(1, 1));
  for (Eigen::Index row = 0; row < e.size(); row += 3)
    out.residuals.push_back(e.segment<3>(row).norm());
  out.rms = std::sqrt(e.squaredNorm() / static_cast<double>(poses.size()));
  return out;
}

// counts = c torque(weight of (m + m0)): linear in c and c m0.
GainFit fit_gain(const FalconGeometry& geometry, std::span<const KnownLoad> loads) {
  constexpr double kLeastSpread = 0.020;  // [kg]
  GainFit out;
  if (loads.size() < 2) return out;
  const auto [least, most] = std::ranges::minmax(loads, {}, &KnownLoad::mass);
  if (most.mass - least.mass < kLeastSpread) return out;
  Eigen::MatrixXd A(3 * static_cast<Eigen::Index>(loads.size()), 2);
  Eigen::VectorXd counts(A.rows());
  std::vector<FalconJacobian> maps;
  for (const KnownLoad& load : loads) {
    const auto row = 3 * static_cast<Eigen::Index>(maps.size());
    maps.push_back(jacobian(geometry, load.p_MH));
    if (maps.back().status != Status::ok) return out;
    const Vec3 tau = torque(maps.back(), kGravity * Vec3::UnitY());
    A.block<3, 1>(row, 0) = load.mass * tau;
    A.block<3, 1>(row, 1) = tau;
    counts.segment<3>(row) = load.motors;
  }
  const Eigen::Vector2d x = A.colPivHouseholderQr().solve(counts);
  const Eigen::VectorXd e = counts - A * x;
  const double variance = e.squaredNorm() / static_cast<double>(e.size() - 2);
  out.good = x.allFinite() && x[0] != 0;
  out.counts_per_newton_meter = x[0];
  out.gain_sd = std::sqrt(variance * (A.transpose() * A).inverse()(0, 0));
  out.grip_mass = x[1] / x[0];
  for (std::size_t i = 0; i < loads.size(); ++i)
    out.residuals.push_back(
        force(maps[i], e.segment<3>(3 * static_cast<Eigen::Index>(i)) / x[0]).norm());
  return out;
}

}  // namespace farhand::falcon_usb
