#include "master/guidance.hpp"

#include <gtest/gtest.h>

#include <random>

namespace farhand::guidance_test {
namespace {

constexpr unsigned kSeed = 5;
const Vec3 kRest = Vec3::Zero();

TEST(Guidance, AWallPushesOnlyFromBehindAndNeverPulls) {
  const Fixture wall{.shape = PlaneFixture{.point_M = Vec3(0.1, 0, 0), .normal_M = Vec3::UnitX()},
                     .stiffness = 500,
                     .damping = 10,
                     .max_force = 8};
  EXPECT_EQ(fixture_force(wall, Vec3(0.101, 5, 5), Vec3(-1, 0, 0)), Vec3::Zero());
  EXPECT_NEAR((fixture_force(wall, Vec3(0.09, 1, 2), kRest) - Vec3(5, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(fixture_force(wall, Vec3(0.09, 0, 0), Vec3(-0.1, 1, 0)).x(), 6, 1e-12);
  EXPECT_EQ(fixture_force(wall, Vec3(0.099, 0, 0), Vec3(1, 0, 0)), Vec3::Zero()) << "sticky";
  EXPECT_NEAR(fixture_force(wall, Vec3(0, 0, 0), kRest).x(), 8, 1e-12) << "capped";
}

TEST(Guidance, TouchingAWallFastMakesNoJump) {
  const Fixture wall{.stiffness = 300, .damping = 3};
  const Vec3 v(0, 0, -0.5);
  Vec3 last = Vec3::Zero();
  for (int k = -2; k < 20; ++k) {
    const Vec3 f = fixture_force(wall, 1e-3 * (k + 0.3) * v, v);
    EXPECT_LE((f - last).norm(), 0.9 * (1 + 1e-9)) << k;  // the whole damper at once: 1.5 N
    last = f;
  }
}

TEST(Guidance, APlaneALineAndASphereHoldTheGrip) {
  const Fixture plane{.shape = PlaneFixture{.normal_M = Vec3::UnitZ(), .two_sided = true},
                      .stiffness = 100,
                      .damping = 2};
  EXPECT_NEAR((fixture_force(plane, Vec3(1, 1, 0.02), kRest) - Vec3(0, 0, -2)).norm(), 0, 1e-12);
  EXPECT_NEAR((fixture_force(plane, Vec3(1, 1, -0.02), Vec3(1, 1, 0.5)) - Vec3(0, 0, 1)).norm(), 0,
              1e-12);
  const Fixture line{.shape = AxisFixture{.point_M = Vec3(0, 0, 1), .direction_M = Vec3::UnitX()},
                     .stiffness = 100,
                     .damping = 2};
  EXPECT_NEAR((fixture_force(line, Vec3(7, 0.01, 1.02), Vec3(1, 0, 0)) - Vec3(0, -1, -2)).norm(), 0,
              1e-12);
  const auto sphere = [](SphereFixture::Keep keep) {
    return Fixture{.shape = SphereFixture{.radius = 0.02, .keep = keep}, .stiffness = 100};
  };
  using Keep = SphereFixture::Keep;
  EXPECT_EQ(fixture_force(sphere(Keep::inside), Vec3(0.01, 0, 0), kRest), Vec3::Zero());
  EXPECT_NEAR(fixture_force(sphere(Keep::inside), Vec3(0, 0.03, 0), kRest).y(), -1, 1e-12);
  EXPECT_NEAR(fixture_force(sphere(Keep::outside), Vec3(0, 0.01, 0), kRest).y(), 1, 1e-12);
  EXPECT_EQ(fixture_force(sphere(Keep::outside), Vec3(0, 0.03, 0), kRest), Vec3::Zero());
  EXPECT_EQ(fixture_force(sphere(Keep::attract), Vec3(0, 0.021, 0), kRest), Vec3::Zero());
  EXPECT_NEAR(fixture_force(sphere(Keep::attract), Vec3(0, 0.01, 0), kRest).y(), -0.75, 1e-12);
  EXPECT_TRUE(fixture_force(sphere(Keep::outside), Vec3::Zero(), kRest).allFinite());
}

// Springs without memory give back what they take: no closed way gains energy.
TEST(Guidance, FixturesWithoutDampingConserveEnergy) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-0.05, 0.05);
  using Keep = SphereFixture::Keep;
  std::vector<Fixture> fixtures{{.shape = PlaneFixture{.normal_M = Vec3::UnitY()}},
                                {.shape = AxisFixture{}},
                                {.shape = SphereFixture{.keep = Keep::inside}},
                                {.shape = SphereFixture{.keep = Keep::outside}},
                                {.shape = SphereFixture{.keep = Keep::attract}}};
  for (Fixture& f : fixtures) {
    f.damping = 0;
    for (int loop = 0; loop < 5; ++loop) {
      const Vec3 a(uniform(random), uniform(random), uniform(random)),
          b(uniform(random), uniform(random), uniform(random)), c = a.cross(b).normalized() * 0.03;
      double work = 0, moved = 0;
      constexpr int kSteps = 20000;
      const auto at = [&](int k) {
        const double t = 2 * std::numbers::pi * k / kSteps;
        return Vec3(std::cos(t) * a + std::sin(t) * b + std::sin(2 * t) * c);
      };
      for (int k = 0; k < kSteps; ++k) {
        const Vec3 step = at(k + 1) - at(k);
        const double w = fixture_force(f, (at(k + 1) + at(k)) / 2, kRest).dot(step);
        work += w, moved += std::abs(w);
      }
      EXPECT_NEAR(work, 0, 1e-5 * (moved + 1e-3))
          << "seed " << kSeed << " fixture " << f.shape.index();
    }
  }
}

// ---- the handle's own limits

// Moves outwards from the middle until the end of acceptance; the force must be zero in the middle,
// grow on the way, point inwards, and be whole at the end.
template <typename ForceAt, typename AcceptedAt>
void expect_grows_before_acceptance_ends(const std::string& way, ForceAt force_at,
                                         AcceptedAt accepted_at, const WorkspaceEdge& edge) {
  constexpr double kStep = 1e-4;
  ASSERT_TRUE(accepted_at(0)) << way;
  EXPECT_EQ(force_at(0).norm(), 0) << way;
  double last = 0, s = 0, inward = 0;
  for (; s < 0.3 && accepted_at(s); s += kStep) {
    const Vec3 f = force_at(s);
    last = f.norm();
    inward = f.x();
  }
  ASSERT_LT(s, 0.3) << way;
  EXPECT_GT(last, 0.9 * edge.max_force) << way;
  EXPECT_LT(inward, 0) << way;
}

Mat3 frame_along(const Vec3& d) {
  return Quat::FromTwoVectors(Vec3::UnitX(), d).toRotationMatrix();
}

TEST(HandleLimits, AFalconPushesBackBeforeItsAcceptanceEnds) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const WorkspaceEdge edge;
  for (int k = 0; k < 40; ++k) {
    const Vec3 d = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Mat3 R = frame_along(d);
    const auto at = [&](double s) { return Vec3(Vec3(0, 0, 0.12) + s * d); };
    const auto J = [&](double s) { return jacobian(kFalconTable1, at(s)); };
    const auto force = [&](double s) {
      const FalconMotorAngles angles = motor_angles(kFalconTable1, at(s));
      const FalconForward forward_at = forward(kFalconTable1, angles.theta1, at(s));
      return Vec3(R.transpose() * edge_force(kFalconTable1, forward_at, J(s), edge));
    };
    expect_grows_before_acceptance_ends(
        "seed " + std::to_string(kSeed) + " direction " + std::to_string(k), force,
        [&](double s) { return accepted(kFalconTable1, J(s)); }, edge);
  }
}

// What an edge should do, from its measure's spare and a gradient found by differences.
Vec3 expected_push(const WorkspaceEdge& e, double spare, const Vec3& gradient) {
  const double near = 1 - spare / (gradient.norm() * e.margin);
  return near > 0 ? Vec3(e.max_force * std::min(1.0, near) * gradient.normalized()) : Vec3::Zero();
}

constexpr double kDifference = 1e-6;  // [m]

TEST(HandleLimits, AFalconsEdgesPushAlongTheGradientsOfTheirMeasures) {
  const WorkspaceEdge edge{.margin = 0.02, .max_force = 8};
  const auto spares = [](const Vec3& p) {
    const FalconInverse q = inverse(kFalconTable1, p);
    Eigen::Vector4d out;
    out << (q.theta2 - q.theta1).array().sin() - 0.1, -jacobian(kFalconTable1, p).det_n - 0.1;
    return out;
  };
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-0.06, 0.06);
  int pushed = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 p = Vec3(0, 0, 0.12) + Vec3(uniform(random), uniform(random), uniform(random));
    const FalconJacobian J = jacobian(kFalconTable1, p);
    if (!accepted(kFalconTable1, J)) continue;
    Eigen::Matrix<double, 4, 3> slopes;
    for (int i = 0; i < 3; ++i)
      slopes.col(i) =
          (spares(p + kDifference * Vec3::Unit(i)) - spares(p - kDifference * Vec3::Unit(i))) /
          (2 * kDifference);
    Vec3 expected = Vec3::Zero();
    for (int m = 0; m < 4; ++m) expected += expected_push(edge, spares(p)[m], slopes.row(m));
    const FalconForward at = forward(kFalconTable1, motor_angles(kFalconTable1, p).theta1, p);
    EXPECT_NEAR((edge_force(kFalconTable1, at, J, edge) - expected).norm(), 0, 1e-5)
        << "seed " << kSeed << " sample " << k;
    pushed += expected.norm() > 0.1;
  }
  EXPECT_GT(pushed, 50);
}

TwinDeltaPose twin_pose(const Vec3& p, const Vec3& axis, double length) {
  return {.p_MH = p, .axis = axis.normalized(), .length = length};
}

struct TwinDeltaAt {
  explicit TwinDeltaAt(const TwinDeltaPose& pose)
      : forward_at(forward(kTwinDelta, motor_angles(kTwinDelta, pose).theta1)),
        R_MG(handle_axes(pose.axis)),
        J(jacobian(kTwinDelta, forward_at, R_MG)) {}
  Wrench edge(const WorkspaceEdge& e) const { return edge_wrench(kTwinDelta, forward_at, J, e); }
  bool ok() const { return accepted(kTwinDelta, J); }

  TwinDeltaForward forward_at;
  Mat3 R_MG;
  TwinDeltaJacobian J;
};

TEST(HandleLimits, ATwinDeltaPushesBackBeforeItsAcceptanceEnds) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const WorkspaceEdge edge;
  for (int k = 0; k < 40; ++k) {
    const Vec3 d = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Mat3 R = frame_along(d);
    const auto at = [&](double s) {
      return TwinDeltaAt(twin_pose(Vec3(0.18, 0, 0) + s * d, Vec3::UnitZ(), 0.17));
    };
    // Of the two ends' pushes the sum is felt: at least that of the end that stops first.
    expect_grows_before_acceptance_ends(
        "seed " + std::to_string(kSeed) + " direction " + std::to_string(k),
        [&](double s) {
          const TwinDeltaAt t = at(s);
          return Vec3(R.transpose() * (t.R_MG * t.edge(edge).force));
        },
        [&](double s) { return at(s).ok(); }, edge);
  }
}

TEST(HandleLimits, ATwinDeltaResistsTheEndsOfItsTwistAndTilt) {
  const WorkspaceEdge edge;
  const auto twisted = [&](double length) {
    return TwinDeltaAt(twin_pose(Vec3(0.18, 0, 0), Vec3::UnitZ(), length)).edge(edge).torque.z();
  };
  EXPECT_EQ(twisted(0.17), 0);
  EXPECT_NEAR(twisted(0.2), -kTwinDelta.k * edge.max_force, 1e-9);  // back from the long end
  EXPECT_NEAR(twisted(0.14), kTwinDelta.k * edge.max_force, 1e-9);
  EXPECT_NEAR(twisted(0.194), -0.5 * kTwinDelta.k * edge.max_force, 1e-9);
  const auto tilted = [&](double degrees) {
    const double b = degrees * std::numbers::pi / 180;
    const TwinDeltaAt t(twin_pose(Vec3(0.18, 0, 0), Vec3(std::sin(b), 0, std::cos(b)), 0.17));
    EXPECT_TRUE(t.ok());
    return t.edge(edge).torque.y();  // about +y the axis turns towards +x
  };
  EXPECT_EQ(tilted(60), 0);
  EXPECT_LT(tilted(84.9), -0.9 * 0.5 * edge.max_force * 0.17);
  EXPECT_GT(tilted(-84.9), 0.9 * 0.5 * edge.max_force * 0.17);
}

// The six levers and two determinants, and length, length and tilt.
Eigen::Matrix<double, 11, 1> twin_delta_spares(const Vec3& p_ME1, const Vec3& p_ME2) {
  const Vec3 span = p_ME1 - p_ME2;
  const TwinDeltaAt t(twin_pose((p_ME1 + p_ME2) / 2, span, span.norm()));
  const Vec3 bend(1, -1, 1);
  Eigen::Matrix<double, 11, 1> out;
  out << t.J.half[0].lever.cwiseProduct(bend).array() - 0.02, t.J.half[0].bars.det - 0.15,
      t.J.half[1].lever.cwiseProduct(bend).array() - 0.02, t.J.half[1].bars.det - 0.15,
      span.norm() - 0.14, 0.2 - span.norm(),
      std::sin(85 * std::numbers::pi / 180) - std::abs(span.x()) / span.norm();
  return out;
}

TEST(HandleLimits, ATwinDeltasEdgesPushItsEndsAlongTheGradientsOfTheirMeasures) {
  const WorkspaceEdge edge{.margin = 0.03, .max_force = 8};
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int pushed = 0;
  for (int k = 0; k < 300; ++k) {
    const auto cube = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
    const TwinDeltaAt t(twin_pose(Vec3(0.18, 0, 0) + 0.1 * cube(), Vec3::UnitZ() + 0.8 * cube(),
                                  0.17 + 0.03 * uniform(random)));
    if (!t.ok()) continue;
    const Vec3 E1 = t.forward_at.p_ME1, E2 = t.forward_at.p_ME2;
    Eigen::Matrix<double, 11, 3> by_E1, by_E2;
    for (int i = 0; i < 3; ++i) {
      const Vec3 d = kDifference * Vec3::Unit(i);
      by_E1.col(i) =
          (twin_delta_spares(E1 + d, E2) - twin_delta_spares(E1 - d, E2)) / (2 * kDifference);
      by_E2.col(i) =
          (twin_delta_spares(E1, E2 + d) - twin_delta_spares(E1, E2 - d)) / (2 * kDifference);
    }
    const auto spares = twin_delta_spares(E1, E2);
    Vec3 f_E1 = Vec3::Zero(), f_E2 = Vec3::Zero();
    for (int m = 0; m < 4; ++m) f_E1 += expected_push(edge, spares[m], by_E1.row(m));
    for (int m = 4; m < 8; ++m) f_E2 += expected_push(edge, spares[m], by_E2.row(m));
    for (int m = 8; m < 11; ++m) {
      const Vec3 apart = expected_push(edge, spares[m], by_E1.row(m) - by_E2.row(m)) / 2;
      f_E1 += apart, f_E2 -= apart;
    }
    const Wrench expected = wrench(t.J, EndForces{f_E1, Vec3(f_E2.x(), -f_E2.y(), -f_E2.z())});
    const Wrench F = t.edge(edge);
    EXPECT_NEAR((F.force - expected.force).norm(), 0, 1e-5) << "seed " << kSeed << " sample " << k;
    EXPECT_NEAR((F.torque - expected.torque).norm(), 0, 1e-6);
    pushed += expected.force.norm() > 0.1;
  }
  EXPECT_GT(pushed, 50);
}

TEST(Guidance, IsFeltInHandleAxesAndAddsUp) {
  HandlePose pose{.status = Status::ok};
  pose.R_MG = rotation(Vec3(0.3, -0.2, 0));
  pose.X_MH.p = Vec3(0, 0, -0.01);
  const Fixture floor{.shape = PlaneFixture{}, .stiffness = 200, .damping = 0};
  const GuidanceConfig config{.fixtures = {floor, floor}};
  const Wrench F = guide(config, Handle{}, pose, {});
  EXPECT_NEAR((pose.R_MG * F.force - Vec3(0, 0, 4)).norm(), 0, 1e-12);
  EXPECT_EQ(F.torque, Vec3::Zero());
  pose.status = Status::no_solution;
  EXPECT_EQ(guide(config, Handle{}, pose, {}).force, Vec3::Zero());
}

}  // namespace
}  // namespace farhand::guidance_test
