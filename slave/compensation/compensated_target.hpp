// The method that a scene names, at the robot. A closed variant; another method is one more entry
// with the same members.
#pragma once

#include <variant>

#include "slave/compensation/chosen_target.hpp"
#include "slave/compensation/damped_target.hpp"
#include "slave/compensation/mediated_target.hpp"

namespace farhand {

using CompensatedTargetConfig =
    std::variant<DampedTargetConfig, MediatedTargetConfig, ChosenTargetConfig>;

class CompensatedTarget {
 public:
  explicit CompensatedTarget(const CompensatedTargetConfig& config) noexcept
      : method_(std::visit([](const auto& c) { return made(c); }, config)) {}

  // At rest in X_MT: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept {
    std::visit([&](auto& m) { m.start(X_MT); }, method_);
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
  using Methods = std::variant<DampedTarget, MediatedTarget, ChosenTarget>;
  static Methods made(const DampedTargetConfig& c) noexcept { return DampedTarget(c); }
  static Methods made(const MediatedTargetConfig& c) noexcept { return MediatedTarget(c); }
  static Methods made(const ChosenTargetConfig& c) noexcept { return ChosenTarget(c); }

  Methods method_;
};

}  // namespace farhand
