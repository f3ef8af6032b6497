#include "master/falcon_usb/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/random.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A device that is not as the table says.
FalconGeometry truth() {
  FalconGeometry g;
  g.gear_ratio = 7.71;
  g.angle_offset = 38.4 * kDegree;
  return g;
}

Vec3 counts_at(const FalconGeometry& g, const Vec3& p_MH) {
  return counts_from_theta1(g, motor_angles(g, p_MH).theta1).cast<double>();
}

// A jig's holes, seen from one of its corners, each hit within `error`.
std::vector<KnownPose> poses(double error, std::uint64_t seed) {
  const Vec3 origin(-0.03, -0.02, 0.10);
  Random random(seed);
  std::vector<KnownPose> out;
  for (const double x : {0.0, 0.06})
    for (const double y : {0.0, 0.05})
      for (const double z : {0.0, 0.04}) {
        const Vec3 p(x, y, z);
        const Vec3 missed =
            error * Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        out.push_back({counts_at(truth(), origin + p + missed), p});
      }
  return out;
}

TEST(FalconCalibration, FindsGearAndOffsetWithinWhatTheEncodersResolve) {
  const GeometryFit fit = fit_geometry(kFalconTable1, poses(0, 1));
  ASSERT_TRUE(fit.good);
  EXPECT_NEAR(fit.geometry.gear_ratio, truth().gear_ratio, 0.005);
  EXPECT_NEAR(fit.geometry.angle_offset, truth().angle_offset, 0.02 * kDegree);
  EXPECT_LT((fit.origin_M - Vec3(-0.03, -0.02, 0.10)).norm(), 5e-5);
  EXPECT_LT(fit.rms, 5e-5);  // one count moves the grip by some 40 um
}

TEST(FalconCalibration, SaysHowSureItIs) {
  int within = 0;
  double gear = 0, offset = 0;
  constexpr int kTrials = 100;
  for (int i = 0; i < kTrials; ++i) {
    const GeometryFit fit = fit_geometry(kFalconTable1, poses(1e-3, 10 + i));
    ASSERT_TRUE(fit.good);
    gear += fit.gear_ratio_sd / kTrials;
    offset += fit.angle_offset_sd / kTrials;
    within += std::abs(fit.geometry.gear_ratio - truth().gear_ratio) < 2 * fit.gear_ratio_sd &&
              std::abs(fit.geometry.angle_offset - truth().angle_offset) < 2 * fit.angle_offset_sd;
  }
  std::printf(
      "places missed by up to 0.5 mm along each axis: gear ratio +- %.3f, offset +- %.3f deg\n",
      gear, offset / kDegree);
  EXPECT_GT(within, 80);  // two of two standard deviations: some 91 of 100
  EXPECT_LT(within, 100);
}

// The wrong table of lengths leaves residuals that the right one does not.
TEST(FalconCalibration, TellsTheGeometriesApart) {
  const auto known = poses(0, 1);
  const GeometryFit right = fit_geometry(kFalconTable1, known);
  const GeometryFit wrong = fit_geometry(kFalconLibnifalcon, known);
  ASSERT_TRUE(right.good && wrong.good);
  EXPECT_GT(wrong.rms, 5 * right.rms);
}

TEST(FalconCalibration, RefusesWhatDoesNotTell) {
  auto few = poses(0, 1);
  few.resize(kFewestPoses - 1);
  EXPECT_FALSE(fit_geometry(kFalconTable1, few).good);
  EXPECT_FALSE(fit_geometry(kFalconTable1, std::vector<KnownPose>(8, poses(0, 1)[0])).good);
  auto far = poses(0, 1);
  far[3].counts = Vec3(3000, -3000, 0);
  EXPECT_FALSE(fit_geometry(kFalconTable1, far).good);
}

std::vector<KnownLoad> loads(double friction_newton) {
  constexpr double kGain = -8200, kGripMass = 0.12;
  std::vector<KnownLoad> out;
  double sign = 1;
  for (const Vec3& p : {Vec3(0, 0, 0.115), Vec3(0.02, 0.01, 0.12)})
    for (const double mass : {0.0, 0.1, 0.2}) {
      sign = -sign;
      const FalconJacobian J = jacobian(truth(), p);
      const Vec3 f = ((mass + kGripMass) * kGravity + sign * friction_newton) * Vec3::UnitY();
      out.push_back({p, (kGain * torque(J, f)).array().round().matrix(), mass});
    }
  return out;
}

TEST(FalconCalibration, FindsTheForcePerCountAndWhatTheGripWeighs) {
  const GainFit fit = fit_gain(truth(), loads(0));
  ASSERT_TRUE(fit.good);
  EXPECT_NEAR(fit.counts_per_newton_meter, -8200, 82);
  EXPECT_NEAR(fit.grip_mass, 0.12, 0.003);
  for (const double r : fit.residuals) EXPECT_LT(r, 0.02);
}

TEST(FalconCalibration, FrictionShowsInTheResiduals) {
  const GainFit fit = fit_gain(truth(), loads(0.2));
  ASSERT_TRUE(fit.good);
  EXPECT_LT(std::abs(fit.counts_per_newton_meter + 8200), 3 * fit.gain_sd + 82);
  double most = 0;
  for (const double r : fit.residuals) most = std::max(most, r);
  EXPECT_GT(most, 0.1);
}

TEST(FalconCalibration, RefusesLoadsThatDoNotDiffer) {
  auto same = loads(0);
  for (KnownLoad& load : same) load.mass = 0.1;
  EXPECT_FALSE(fit_gain(truth(), same).good);
  EXPECT_FALSE(fit_gain(truth(), {}).good);
}

}  // namespace
}  // namespace farhand::falcon_usb
