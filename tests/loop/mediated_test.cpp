// The model-mediated method, and `auto`, in whole loops: the twin delta and the arm, over networks
// of any delay.
#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

Scene mediated_over(double rtt_ms, double wall) {
  Scene scene = pressing_over(rtt_ms, wall);
  scene.proto.mutable_compensation()->mutable_mmt();
  return scene;
}

void print(double rtt, double wall, const Pressing& h) {
  std::printf(
      "%3.0f ms, wall %4.0f N/m: felt %.3f of it, drag %.2f N, handle %.2f mm/s rms, robot presses "
      "%.1f N at most, operator's energy %.4f J, %s\n",
      rtt, wall, h.stiffness / wall, h.drag, h.chatter * 1e3, h.peak_contact, h.operator_energy,
      to_string(h.method));
}

TEST(MediatedLoop, FeelsTheWallAtAnyDelay) {
  for (const double rtt : {2., 20., 100., 200., 400.})
    for (const double wall : {200., 500., 1000., 2000., 5000.}) {
      const Pressing h = pressed(mediated_over(rtt, wall), 6);
      print(rtt, wall, h);
    }
}

TEST(MediatedLoop, FeelsTheWallThroughABadNetwork) {
  for (const double wall : {200., 1000., 5000.})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Scene scene = mediated_over(100, wall);
      worsen(scene, 10);
      scene.proto.set_seed(seed);
      const Pressing h = pressed(scene, 6);
      print(100, wall, h);
    }
}

TEST(AutoLoop, FeelsTheWallThroughABadNetwork) {
  for (const double rtt : {1., 20., 100., 400.})
    for (const double wall : {200., 1000., 5000.}) {
      Scene scene = pressing_over(rtt, wall);
      scene.proto.mutable_compensation()->mutable_auto_();
      const Pressing h = pressed(scene, 6);
      print(rtt, wall, h);
    }
}

}  // namespace
}  // namespace farhand
