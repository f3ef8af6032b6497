// The publication's experiments as scenes, by the master's own tick, once on the simulated handle
// and once on the same handle behind the emulated USB.
#include <gtest/gtest.h>

#include "master/build.hpp"
#include "master/build_falcon.hpp"
#include "master/build_sim_hand.hpp"
#include "tests/falcon_usb/armed_grip.hpp"
#include "tests/loop/loopback.hpp"

namespace farhand::falcon_usb {
namespace {

struct Place {
  double t = 0;  // [s] since the motors drive
  Vec3 p_MH = Vec3::Zero();
};
using Course = std::vector<Place>;

Course simulated(const Scene& scene) {
  Course out;
  Loopback loop(scene, {});
  loop.on_master = [&](const MasterTick& t) {
    out.push_back({seconds(t.now - loop.start()), t.handle.X_MH.p});
  };
  loop.run();
  return out;
}

Course through_usb(const Scene& scene) {
  SimHandConfig sim = sim_hand_config(scene, {});
  sim.presses.clear();
  ArmedGrip grip(std::move(sim), falcon_usb_config(scene).driver);
  Master master(master_config(scene.proto));
  Course out;
  const TimePoint start = grip.now;
  while (seconds(grip.now - start) < scene.proto.duration_s()) {
    master.sample(grip.now, grip.driver.read(grip.now), {});
    const MasterTick& tick = master.actuate(grip.now, {});
    grip.driver.write(grip.now, tick.tau);
    out.push_back({seconds(grip.now - start), tick.handle.X_MH.p});
    grip.live(from_seconds(1 / scene.proto.rate_hz()));
  }
  EXPECT_EQ(grip.driver.status().phase, Phase::armed);
  return out;
}

// How far off the target the grip was in [from, until), and when it was last more than 1.5 mm off.
struct Excursion {
  double peak = 0;       // [m]
  double settled_s = 0;  // after from
};
Excursion excursion(const Course& course, const Vec3& target, double from, double until) {
  constexpr double kNear = 0.0015;  // [m]
  Excursion out;
  for (const Place& place : course) {
    if (place.t < from || place.t >= until) continue;
    const double off = (place.p_MH - target).norm();
    out.peak = std::max(out.peak, off);
    if (off > kNear) out.settled_s = place.t - from;
  }
  return out;
}

void expect_same(const std::string& name) {
  const Scene scene = load_scene(FARHAND_SOURCE_DIR "/deploy/scenes/" + name + ".textproto");
  const Course plain = simulated(scene), usb = through_usb(scene);
  const auto& points = scene.proto.master().position_control().set_point(0).position_m();
  const Vec3 target(points[0], points[1], points[2]);
  std::vector<double> begins{0};
  for (const auto& p : scene.proto.master().sim_hand().push()) begins.push_back(p.at_s());
  const double count = 0.06 * theta1_quantum(kFalconTable1);  // [m] at the arm's end
  const double tick = 1 / scene.proto.rate_hz();
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const double until = i + 1 < begins.size() ? begins[i + 1] : scene.proto.duration_s();
    const Excursion a = excursion(plain, target, begins[i], until);
    const Excursion b = excursion(usb, target, begins[i], until);
    std::printf("%s from %4.1f s: %.2f s and %.2f s, farthest %.2f mm and %.2f mm\n", name.c_str(),
                begins[i], a.settled_s, b.settled_s, 1e3 * a.peak, 1e3 * b.peak);
    EXPECT_LE(std::abs(a.settled_s - b.settled_s), 0.02 * a.settled_s + tick) << begins[i];
    EXPECT_LE(std::abs(a.peak - b.peak), 0.02 * a.peak + count) << begins[i];
  }
}

TEST(FalconScenes, F1IsTheSameThroughTheUsb) {
  expect_same("falcon_f1");
}
TEST(FalconScenes, F2IsTheSameThroughTheUsb) {
  expect_same("falcon_f2");
}

}  // namespace
}  // namespace farhand::falcon_usb
