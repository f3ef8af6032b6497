#include "tests/loop/run.hpp"

#include <bit>
#include <chrono>

#include "common/scene_values.hpp"
#include "master/record.hpp"
#include "slave/record.hpp"
#include "tests/loop/truth.hpp"

namespace farhand {
namespace {

// Order-sensitive mix of the bits of doubles.
class Digest {
 public:
  void add(const Vec6& v) noexcept {
    for (double x : v)
      value_ = (std::rotl(value_, 5) ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
  }
  std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0;
};

// Begins of set points and pushes, and how far off target the grip still is after each.
class SettlingWatch {
 public:
  explicit SettlingWatch(const proto::Scene& scene) {
    for (const auto& s : scene.master().position_control().set_point())
      begins_.push_back({.at_s = s.at_s()});
    for (const auto& p : scene.master().sim_hand().push()) begins_.push_back({.at_s = p.at_s()});
    std::sort(begins_.begin(), begins_.end(),
              [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
  }
  void add(double t, const Vec3& error) {
    constexpr double kSettled = 0.0015;  // [m], the publication's accuracy
    while (next_ < begins_.size() && begins_[next_].at_s <= t + 1e-9) ++next_;
    if (next_ == 0) return;
    Settling& s = begins_[next_ - 1];
    s.peak_m = std::max(s.peak_m, error.norm());
    if (error.cwiseAbs().maxCoeff() > kSettled) s.settled_after_s = t - s.at_s;
  }
  const std::vector<Settling>& result() const { return begins_; }

 private:
  std::vector<Settling> begins_;
  std::size_t next_ = 0;
};

}  // namespace

RunResult run_scene(const Scene& scene, const LoopbackOptions& options, RecordingFile* file) {
  RunResult out;
  Loopback loop(scene, options);
  std::optional<MasterRecording> master_recording;
  std::optional<SlaveRecording> slave_recording;
  if (file != nullptr) master_recording.emplace(*file, scene.proto);
  if (file != nullptr && loop.slave() != nullptr)
    slave_recording.emplace(*file, loop.slave()->config());
  Vec3 p_MH = Vec3::Zero();  // as measured last
  Checkers checkers(loop);
  Digest digest;
  SettlingWatch settling(scene.proto);

  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    out.master.add(t);
    digest.add(t.reading.theta);
    digest.add(t.tau);
    p_MH = t.handle.X_MH.p;
    const auto user = true_user(loop.device(), t.handle.R_MG);
    if (user && t.mode == Mode::engaged && t.coupled)
      (t.F_env_G.force.norm() > kContactForce ? out.user_to_environment_contact
                                              : out.user_to_environment_free)
          .add(*user - t.F_env_G);
    if (t.position_controlled)
      settling.add(seconds(t.now - loop.start()), t.p_MH_target - true_handle(loop.device(), p_MH));
    if (master_recording) master_recording->add({t, {}, loop.master_status()});
  };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    out.slave.add(t);
    digest.add(t.robot.q);
    digest.add(t.tau);
    const auto truth = std::visit([](const auto& r) { return r.truth(); }, *loop.robot());
    out.peak_penetration = std::max(out.peak_penetration, truth.penetration);
    if (slave_recording) slave_recording->add({t, {}, loop.slave_status()});
    if (!t.coupled) return;
    const double error =
        (wanted_tool(*loop.slave(), true_handle(loop.device(), p_MH)) - truth.X_SE.p).norm();
    (truth.F_E_S.force.norm() > kContactForce ? out.handle_to_robot_contact
                                              : out.handle_to_robot_free)
        .add(error);
  };

  const auto begin = std::chrono::steady_clock::now();
  loop.run();
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  out.simulated_s = seconds(loop.end() - loop.start());
  out.settling = settling.result();
  out.master_link = loop.master_link();
  if (loop.slave_link() != nullptr) out.slave_link = *loop.slave_link();
  out.quality = loop.quality();
  out.violations = checkers.count();
  out.first_violations = checkers.first();
  out.digest = digest.value();
  return out;
}

}  // namespace farhand
