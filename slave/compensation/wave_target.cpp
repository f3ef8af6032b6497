#include "slave/compensation/wave_target.hpp"

namespace farhand {

WaveTarget::WaveTarget(const WaveTargetConfig& c) noexcept
    : wave_(c.translation, c.servo_stiffness), mass_(c.mass) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

void WaveTarget::hear(const Peer<MasterToSlave>& master, TimePoint now) noexcept {
  if (master.session != heard_) wave_.clear();
  heard_ = master.session;
  wave_.push(master.sent, master.newest->wave, (now - master.age).time_since_epoch());
}

void WaveTarget::start(const Pose& X_MT) noexcept {
  p_MT_ = X_MT.p;
  wave_.start();
  if (rotation_) rotation_->start(X_MT.R);
}

Pose WaveTarget::step(const TargetInputs& in) noexcept {
  const Vec3& p = in.X_MT.p;
  const Vec3 v = (p - p_MT_) / mass_.Ts;
  const Vec3 F_s = wave_.step(v, in.now.time_since_epoch());
  p_MT_ = p;
  return {rotation_ ? rotation_->step(in) : in.X_MT.R,
          p + mass_.Ts * farhand::step(mass_, v, F_s, in.F_E_M.force)};
}

void WaveTarget::tell(SlaveToMaster& out) const noexcept {
  out.energies = {0, rotation_ ? rotation_->told() : 0};
  out.has_wave = true;
  out.wave = wave_.sum();
}

}  // namespace farhand
