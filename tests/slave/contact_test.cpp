#include "slave/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/random.hpp"

namespace farhand {
namespace {

constexpr std::uint64_t kSeed = 3;

Surfaces only(const Surface& s) {
  Surfaces out;
  out.items[0] = s;
  out.count = 1;
  return out;
}

Tip tip_at(const Vec3& p, double radius = 0, const Vec3& velocity = Vec3::Zero()) {
  return {.X_SE = {Mat3::Identity(), p}, .V_E_S = {Vec3::Zero(), velocity}, .radius = radius};
}

Vec3 draw(Random& random, double limit) {
  return limit * Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
}

Box turned_box() {
  return {.X_SB = {rotation(Vec3(0.3, -0.5, 0.9)), Vec3(0.1, -0.2, 0.3)},
          .half_extents = Vec3(0.10, 0.06, 0.04),
          .edge_radius = 0.005};
}

TEST(Contact, PressingOnAPlanePushesItAlongMinusItsNormal) {
  const Surfaces s = only({.shape = Plane{}, .stiffness = 2e4});
  const Wrench F = contact_wrench(s, {}, tip_at(Vec3(0.1, 0.2, -0.001)));
  EXPECT_NEAR((F.force - Vec3(0, 0, -20)).norm(), 0, 1e-12);
  EXPECT_EQ(F.torque, Vec3::Zero());
}

TEST(Contact, DampingAddsOnTheWayInAndNeverPullsOnTheWayOut) {
  const Surfaces s = only({.shape = Plane{}, .stiffness = 1000, .damping = 50});
  const auto push = [&](double velocity) {
    return -contact_wrench(s, {}, tip_at(Vec3(0, 0, -0.01), 0, Vec3(0, 0, velocity))).force.z();
  };
  EXPECT_NEAR(push(-0.1), 15, 1e-12);
  EXPECT_NEAR(push(0.1), 5, 1e-12);
  EXPECT_EQ(push(1), 0);
}

TEST(Contact, SphereAndTipRadiusAddUp) {
  const Surfaces s = only({.shape = Sphere{Vec3(0, 0, 1), 0.2}, .stiffness = 1000});
  EXPECT_EQ(contact_wrench(s, {}, tip_at(Vec3(0, 0.211, 1), 0.01)).force, Vec3::Zero());
  const Vec3 f = contact_wrench(s, {}, tip_at(Vec3(0, 0.2, 1), 0.01)).force;
  EXPECT_NEAR((f - Vec3(0, -10, 0)).norm(), 0, 1e-12);
  EXPECT_TRUE(contact_wrench(s, {}, tip_at(Vec3(0, 0, 1))).force.allFinite());
}

TEST(Contact, BoxDistanceIsThatOfTheRoundedBox) {
  const Box box{.half_extents = Vec3(0.1, 0.1, 0.1), .edge_radius = 0.02};
  EXPECT_NEAR(proximity(box, Vec3(0, 0, 0.13)).distance, 0.03, 1e-15);
  EXPECT_NEAR(proximity(box, Vec3(0, -0.09, 0)).distance, -0.01, 1e-15);
  EXPECT_NEAR((proximity(box, Vec3(0, -0.09, 0)).normal + Vec3::UnitY()).norm(), 0, 1e-15);
  EXPECT_NEAR(proximity(box, Vec3(0.11, 0.11, 0)).distance, 0.03 * std::sqrt(2) - 0.02, 1e-15);
  EXPECT_NEAR(proximity(box, Vec3(0.1, -0.1, 0.1)).distance, 0.02 * std::sqrt(3) - 0.02, 1e-15);
}

TEST(Contact, NormalIsTheSlopeOfTheDistance) {
  Random random(kSeed);
  for (const Shape& shape : {Shape(turned_box()), Shape(Sphere{Vec3(0.1, 0, 0.2), 0.1}),
                             Shape(Plane{Vec3(0, 0, 0.1), Vec3(0.6, 0, 0.8)})}) {
    for (int k = 0; k < 1000; ++k) {
      const Vec3 p = Vec3(0.1, -0.2, 0.3) + draw(random, 0.2), step = draw(random, 1e-7);
      if (proximity(shape, p).distance < -0.004)
        continue;  // deep in the box the nearest face flips
      const double rise = proximity(shape, p + step).distance - proximity(shape, p - step).distance;
      EXPECT_NEAR(rise / 2, proximity(shape, p).normal.dot(step), 1e-11) << "seed " << kSeed;
    }
  }
}

TEST(Contact, NothingIsFeltOutside) {
  Random random(kSeed);
  const Box box = turned_box();
  const Surfaces s = only({.shape = box, .stiffness = 1e6, .damping = 1e3, .friction = 1});
  int outside = 0;
  for (int k = 0; k < 10000; ++k) {
    const Vec3 p = box.X_SB.p + draw(random, 0.15);
    const Vec3 p_B = box.X_SB.R.transpose() * (p - box.X_SB.p);
    if (((p_B.cwiseAbs() - box.half_extents).array() <= 0).all()) continue;
    ++outside;
    const Wrench F = contact_wrench(s, {}, tip_at(p, 0, draw(random, 1)));
    ASSERT_EQ(F.force, Vec3::Zero()) << "seed " << kSeed << " draw " << k;
    ASSERT_EQ(F.torque, Vec3::Zero());
  }
  EXPECT_GT(outside, 1000);
}

// For a point at depth d in a rounding of radius rho the force turns at most by k d / (rho - d) per
// metre, and grows by k.
TEST(Contact, ForceIsContinuousOverFacesEdgesAndCorners) {
  Random random(kSeed);
  const Box box = turned_box();
  const double k = 1e5, tip_radius = 0.003, reach = box.edge_radius + tip_radius;
  const Surfaces s = only({.shape = box, .stiffness = k});
  int touching = 0;
  for (int n = 0; n < 100000; ++n) {
    const Vec3 corner = box.half_extents.cwiseProduct(Vec3(random.uniform() < 0.5 ? 1 : -1, 1, -1));
    const Vec3 p = box.X_SB.p + box.X_SB.R * (corner + draw(random, 0.02));
    const Vec3 step = draw(random, 1e-6);
    const double depth = penetration(s, p, tip_radius);
    if (depth > 0.7 * reach) continue;
    touching += depth > 0;
    const Vec3 change = contact_wrench(s, {}, tip_at(p + step, tip_radius)).force -
                        contact_wrench(s, {}, tip_at(p, tip_radius)).force;
    const double steepest = k * std::max(1.0, depth / (reach - depth)) * 1.01;
    ASSERT_LE(change.norm(), steepest * step.norm() + 1e-9) << "seed " << kSeed << " draw " << n;
  }
  EXPECT_GT(touching, 5000);
}

TEST(Contact, FrictionSticksThenSlidesAtMuTimesTheNormalForce) {
  const double depth = 0.001, kt = 5000;
  const Surfaces s =
      only({.shape = Plane{}, .stiffness = 1e4, .friction = 0.4, .tangential_stiffness = kt});
  ContactState state;
  double furthest = 0;
  const auto drag = [&](double x) {
    const Tip tip = tip_at(Vec3(x, 0, -depth));
    const Vec3 f = contact_wrench(s, state, tip).force;
    update_anchors(s, state, tip);
    return f.x();
  };
  EXPECT_EQ(drag(0), 0);
  const double limit = 0.4 * 1e4 * depth;
  for (double x = 0; x < 0.003; x += 1e-5) {
    EXPECT_NEAR(drag(x), std::min(limit, kt * x), 1e-9);
    furthest = x;
  }
  EXPECT_NEAR(drag(furthest - 1e-4), limit - kt * 1e-4,
              1e-9);  // the bristle relaxes on the way back
  EXPECT_NEAR(drag(furthest - 0.003), -limit, 1e-9);
}

TEST(Contact, AHeldTipDoesNotCreep) {
  const Surfaces s =
      only({.shape = Plane{}, .stiffness = 1e4, .friction = 0.4, .tangential_stiffness = 5000});
  ContactState state;
  update_anchors(s, state, tip_at(Vec3(0, 0, -0.001)));
  const Tip held = tip_at(Vec3(0.0007, 0, -0.001));
  const Vec3 f = contact_wrench(s, state, held).force;
  for (int k = 0; k < 100000; ++k) update_anchors(s, state, held);
  EXPECT_EQ(contact_wrench(s, state, held).force, f);
  EXPECT_NEAR(f.x(), 3.5, 1e-12);
}

TEST(Contact, PartingForgetsTheAnchor) {
  const Surfaces s = only({.shape = Plane{}, .friction = 1});
  ContactState state;
  update_anchors(s, state, tip_at(Vec3(0, 0, -0.001)));
  update_anchors(s, state, tip_at(Vec3(0, 0, 0.001)));
  update_anchors(s, state, tip_at(Vec3(0.5, 0, -0.001)));
  EXPECT_EQ(contact_wrench(s, state, tip_at(Vec3(0.5, 0, -0.001))).force.x(), 0);
}

TEST(Contact, FrictionOnATipWithARadiusTurnsTheTool) {
  const Surfaces s =
      only({.shape = Plane{}, .stiffness = 1e4, .friction = 1, .tangential_stiffness = 1000});
  ContactState state;
  update_anchors(s, state, tip_at(Vec3(0, 0, 0.009), 0.01));
  const Wrench F = contact_wrench(s, state, tip_at(Vec3(0.002, 0, 0.009), 0.01));
  EXPECT_NEAR((F.force - Vec3(2, 0, -10)).norm(), 0, 1e-10);
  EXPECT_NEAR((F.torque - Vec3(0, -0.02, 0)).norm(), 0, 1e-12);
}

TEST(Contact, ATipThatSpinsOnTheSpotIsHeldBack) {
  const Surfaces s = only({.shape = Plane{}, .friction = 1, .tangential_stiffness = 1000});
  ContactState state;
  Tip tip = tip_at(Vec3(0, 0, 0.009), 0.01);
  update_anchors(s, state, tip);
  tip.X_SE.R = rotation(Vec3(0, 0.01, 0));  // about its centre: the pole moves by -0.1 mm
  EXPECT_NEAR(contact_wrench(s, state, tip).force.x(), -0.1, 1e-5);
  tip.X_SE.R = rotation(Vec3(0, 0, 1));  // about the normal: the pole stays
  EXPECT_NEAR(contact_wrench(s, state, tip).force.x(), 0, 1e-12);
}

TEST(Contact, SurfacesAddUpAndNoneGivesNothing) {
  Surfaces s = only({.shape = Plane{}, .stiffness = 1000});
  s.items[1] = {.shape = Plane{Vec3::Zero(), Vec3::UnitX()}, .stiffness = 500};
  const Tip corner = tip_at(Vec3(-0.002, 0, -0.001));
  EXPECT_NEAR(contact_wrench(s, {}, corner).force.x(), 0, 0);
  s.count = 2;
  EXPECT_NEAR((contact_wrench(s, {}, corner).force - Vec3(-1, 0, -1)).norm(), 0, 1e-12);
  s.count = 0;
  EXPECT_EQ(contact_wrench(s, {}, corner).force, Vec3::Zero());
  EXPECT_LT(penetration(s, corner.X_SE.p, 0), 0);
}

}  // namespace
}  // namespace farhand
