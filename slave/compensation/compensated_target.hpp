// The method that a scene names, at the robot. A closed variant; another method is one more entry
// with the same members.
#pragma once

#include <variant>

#include "common/peer.hpp"
#include "slave/compensation/chosen_target.hpp"
#include "slave/compensation/damped_target.hpp"
#include "slave/compensation/direct_target.hpp"
#include "slave/compensation/mediated_target.hpp"
#include "slave/compensation/smith_target.hpp"
#include "slave/compensation/wave_target.hpp"

namespace farhand {

using CompensatedTargetConfig =
    std::variant<DampedTargetConfig, MediatedTargetConfig, ChosenTargetConfig, DirectTargetConfig,
                 WaveTargetConfig, SmithTargetConfig>;

class CompensatedTarget {
 public:
  explicit CompensatedTarget(const CompensatedTargetConfig& config) noexcept
      : method_(std::visit([](const auto& c) { return made(c); }, config)) {}

  // In every tick with a message, its newest, also while nothing is coupled.
  void hear(const Peer<MasterToSlave>& master, TimePoint now) noexcept {
    if (auto* wave = std::get_if<WaveTarget>(&method_)) wave->hear(master, now);
    if (auto* smith = std::get_if<SmithTarget>(&method_)) smith->hear(master, now);
  }
  // At rest in X_MT: when the robot begins to follow, as the workspace says from now on.
  void start(const Pose& X_MT, const WorkspaceConfig& config,
             const WorkspaceState& workspace) noexcept {
    std::visit([&](auto& m) { m.start(X_MT); }, method_);
    if (auto* smith = std::get_if<SmithTarget>(&method_)) smith->place(config, workspace);
  }
  // The target after this tick, as a handle pose, in place of the handle's. The caller limits its
  // speed.
  Pose step(const TargetInputs& in) noexcept {
    return std::visit([&](auto& m) { return m.step(in); }, method_);
  }
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept {
    std::visit([&](const auto& m) { m.tell(out); }, method_);
  }

 private:
  using Methods = std::variant<DampedTarget, MediatedTarget, ChosenTarget, DirectTarget, WaveTarget,
                               SmithTarget>;
  static Methods made(const DampedTargetConfig& c) noexcept { return DampedTarget(c); }
  static Methods made(const MediatedTargetConfig& c) noexcept { return MediatedTarget(c); }
  static Methods made(const ChosenTargetConfig& c) noexcept { return ChosenTarget(c); }
  static Methods made(const DirectTargetConfig& c) noexcept { return DirectTarget(c); }
  static Methods made(const WaveTargetConfig& c) noexcept { return WaveTarget(c); }
  static Methods made(const SmithTargetConfig& c) noexcept { return SmithTarget(c); }

  Methods method_;
};

}  // namespace farhand
