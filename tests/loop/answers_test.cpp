// Answers left out by the deadband, in whole loops: how many go, how far off what is held at the
// hand is, and that nothing else notices.
#include <gtest/gtest.h>

#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

// The demonstration of contact over a fast network, the hand pressing here and there.
Scene sparse(double keep_alive_ms) {
  Scene scene = pressing_over(2, 500);
  scene.proto.clear_compensation();
  scene.proto.mutable_master()->mutable_force_feedback()->set_hold_ms(100);
  scene.proto.mutable_link()->set_stale_ms(200);
  proto::Motion& m = *hand(scene).mutable_motion();
  for (int i = 0; i < 5; ++i) {
    reach(m, kMoved + 4 + 4 * i, 1, Vec3(0.04, 0, 0));
    reach(m, kMoved + 6 + 4 * i, 1, Vec3(-0.04, 0, 0));
  }
  proto::ForceDeadband& d = *scene.proto.mutable_link()->mutable_deadband();
  d.set_keep_alive_ms(keep_alive_ms);
  d.set_floor_newton(0.25), d.set_floor_newton_meter(0.01);
  return scene;
}

struct Sparse {
  double sent = 0;  // share of the ticks that answered
  double off = 0;   // [N rms] of the newest force that the master has, against the present one
  std::uint64_t violations = 0, lost = 0, held = 0;
  bool synced = false;
};

Sparse run(const Scene& scene) {
  Loopback loop(scene, {.duration_s = 32});
  Checkers checkers(loop);
  Sparse out;
  Vec3 F = Vec3::Zero();
  double off2 = 0;
  std::uint64_t ticks = 0, answers = 0, compared = 0;
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    ++ticks, answers += t.answers;
    F = t.out.F_E_M.force;
  };
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    if (seconds(t.now - loop.start()) < 2) return;
    out.held += t.mode != Mode::engaged;
    off2 += (loop.heard()->F_E_M.force - F).squaredNorm(), ++compared;
  };
  loop.run();
  out.sent = static_cast<double>(answers) / static_cast<double>(ticks);
  out.off = std::sqrt(off2 / static_cast<double>(compared));
  out.violations = checkers.count();
  out.lost = loop.quality().lost;
  out.synced = loop.master_end().clock().valid;
  std::printf("keep-alive %2.0f ms: %.1f %% of the answers sent, %.3f N off (rms)\n",
              scene.proto.link().deadband().keep_alive_ms(), 100 * out.sent, out.off);
  return out;
}

TEST(Answers, FewGoAndWhatIsHeldIsWithinWhatIsFelt) {
  const Sparse s = run(sparse(50));
  EXPECT_EQ(s.violations, 0u);
  EXPECT_LE(s.sent, 0.07);
  EXPECT_LE(s.off, 0.25);
  EXPECT_EQ(s.lost, 0u);
  EXPECT_EQ(s.held, 0u);
  EXPECT_TRUE(s.synced);
}

TEST(Answers, OftenEnoughToTellSilenceFromLoss) {
  Scene scene = sparse(5);
  scene.proto.mutable_link()->set_stale_ms(10);
  const Sparse s = run(scene);
  EXPECT_EQ(s.violations, 0u);
  EXPECT_LE(s.sent, 0.2 + 0.07);
  EXPECT_EQ(s.held, 0u);
}

// With direct feedback the guards' sums go with the answers that are sent.
TEST(Answers, TheWallIsFeltTheSameWithoutThem) {
  for (const bool sparsely : {false, true}) {
    Scene scene = pressing_over(2, 500);
    scene.proto.mutable_compensation()->mutable_direct();
    if (sparsely) {
      scene.proto.mutable_master()->mutable_force_feedback()->set_hold_ms(100);
      proto::ForceDeadband& d = *scene.proto.mutable_link()->mutable_deadband();
      d.set_keep_alive_ms(50);
      d.set_floor_newton(0.25), d.set_floor_newton_meter(0.01);
    }
    const Pressing h = pressed(scene, 6);
    std::printf("%s: felt %.3f of the wall, handle %.2f mm/s rms\n",
                sparsely ? "sparse" : "all answers", h.stiffness / 500, h.chatter * 1e3);
    EXPECT_EQ(h.violations, 0u);
    EXPECT_NEAR(h.stiffness / 500, 1, 0.1);
    EXPECT_LT(h.chatter, 0.005);
  }
}

}  // namespace
}  // namespace farhand
