#include "slave/compensation/smith_target.hpp"

namespace farhand {

SmithTarget::SmithTarget(const SmithTargetConfig& c) noexcept : config_(c), poses_(c.playout) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

void SmithTarget::hear(const Peer<MasterToSlave>& master, TimePoint now) noexcept {
  if (master.session != heard_) poses_ = Playout<Vec3>(config_.playout);
  heard_ = master.session;
  poses_.push(master.sent, master.newest->p_MH, (now - master.age).time_since_epoch());
}

void SmithTarget::start(const Pose& X_MT) noexcept {
  poses_.skip_to_newest();
  if (rotation_) rotation_->start(X_MT.R);
}

void SmithTarget::place(const WorkspaceConfig& config, const WorkspaceState& workspace) noexcept {
  wall_ = config_.wall;
  wall_.known = wall_.sure = true;
  wall_.x_w = as_handle(config, workspace, {Mat3::Identity(), config_.wall.x_w}).p;
  wall_.n = config.R_SM.transpose() * config_.wall.n;
}

Pose SmithTarget::step(const TargetInputs& in) noexcept {
  return {rotation_ ? rotation_->step(in) : in.X_MT.R,
          poses_.play(in.now.time_since_epoch(), in.X_MT.p)};
}

void SmithTarget::tell(SlaveToMaster& out) const noexcept {
  out.energies = {0, rotation_ ? rotation_->told() : 0};
  out.has_wall = true;
  out.wall = wall_;
  out.has_acted = true;
  out.acted = static_cast<std::uint64_t>(poses_.given().count());
}

}  // namespace farhand
