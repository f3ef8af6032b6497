#include "master/compensation/wave_coupling.hpp"

namespace farhand {

WaveCoupling::WaveCoupling(const WaveCouplingConfig& c) noexcept
    : wave_(c.translation), max_force_(c.max_force), Ts_(c.translation.Ts) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

void WaveCoupling::hear(const Peer<SlaveToMaster>& slave, TimePoint now) noexcept {
  if (slave.session != heard_) wave_.clear();
  heard_ = slave.session;
  wave_.push(slave.sent, slave.newest->wave, (now - slave.age).time_since_epoch());
}

Wrench WaveCoupling::step(const CouplingInputs& in) noexcept {
  const double share = fade_in_.step(in.share, Ts_);
  if (!coupled_) wave_.start();
  coupled_ = true;
  const Vec3 F_M = wave_.step(in.V_MH.linear, in.now.time_since_epoch(), share, max_force_);
  Wrench F_G{.force = in.handle.R_MG.transpose() * F_M};
  if (rotation_) F_G.torque = rotation_->step(in, share);
  return F_G;
}

void WaveCoupling::let_go() noexcept {
  coupled_ = false;
  if (rotation_) rotation_->let_go();
}

void WaveCoupling::tell(MasterToSlave& out) const noexcept {
  out.method = Method::wave;
  out.has_wave = true;
  out.wave = wave_.sum();
  out.energies = {0, rotation_ ? rotation_->told() : 0};
}

}  // namespace farhand
