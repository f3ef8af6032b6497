// The product's methods on the bench's one axis, wired as a master and a slave would.
#pragma once

#include "common/concealment.hpp"
#include "common/force_guard.hpp"
#include "master/compensation.hpp"
#include "master/compensation/damped.hpp"
#include "master/compensation/local_wall.hpp"
#include "master/compensation/operator_tank.hpp"
#include "master/compensation/smith.hpp"
#include "master/compensation/wave.hpp"
#include "slave/compensation/damped.hpp"
#include "slave/compensation/local_wall.hpp"
#include "slave/compensation/velocity_guard.hpp"
#include "slave/compensation/wave.hpp"
#include "tests/compensation/bench.hpp"

namespace farhand::bench {

inline Vec3 along(double z) {
  return {0, 0, z};
}

// Under guards, or not: forces at the handle, and at the robot a force or a velocity.
class Guarded : public Method {
 public:
  explicit Guarded(bool on) : on_(on) {}
  long acted() const { return acted_; }

 protected:
  double guard(ForceGuard& g, double F, double x) {
    const double out = g.step(along(F), along(x)).z();
    acted_ += g.acting();
    return on_ ? out : F;
  }
  double guard(VelocityGuard& g, double v, double stretch, double F_e) {
    const double out = g.step(along(v), along(stretch), along(F_e)).z();
    acted_ += g.acting();
    return on_ ? out : v;
  }

 private:
  bool on_;
  long acted_ = 0;
};

// The energies that the messages carry between two guards.
template <typename SlaveGuard>
struct Guards {
  ForceGuard master{ForceGuardConfig{}};
  SlaveGuard slave{{}};

  void hear(const Message& m, bool at_master) {
    (at_master ? master.budget() : slave.budget()).receive(m.energy);
  }
  void tell(Message& m, bool by_master) {
    m.energy = by_master ? master.budget().in() : slave.budget().in();
  }
};

// Where the handle is thought to be.
inline double reckon(const SlaveView& s) {
  return s.from.in->x + path({}, s.from.age) * s.from.in->v;
}

struct DampedParts {
  DampedConfig damped;
  VirtualMassConfig mass;
  bool guard = true;
};

// Coupled in contact alone: stiffer for less drag, without any model.
inline DampedParts touching() {
  return {.damped = {.stiffness = 1500, .max_damping = 400, .touch = TouchConfig{}}};
}

class Damped : public Guarded {
 public:
  explicit Damped(const DampedParts& c = {})
      : Guarded(c.guard), mass_(c.mass), master_(c.damped), slave_(c.damped) {}

  void hear(const Message& m, bool at_master, TimePoint) override { guards_.hear(m, at_master); }
  void tell(Message& m, bool by_master) override { guards_.tell(m, by_master); }

  double felt(const MasterView& m) override {
    const double stretch = m.from.in ? m.x - m.from.in->x : 0;
    const Vec3 F_e = along(m.from.in ? m.from.in->F : 0);
    const double F = master_.step(along(stretch), along(m.v), F_e, m.from.echo_age).z();
    const double share = m.from.in ? fade_in_.step(fade(kSpringFade, m.from.age), Bench::kTs) : 0;
    return guard(guards_.master, share * F, m.x);
  }
  double target(const SlaveView& s) override {
    const double stretch = s.from.in ? reckon(s) - s.x_sd : 0;
    const Vec3 v = along(s.v_sd), F_e = along(s.F_e);
    double F_s = slave_.step(along(stretch), v, F_e, s.from.echo_age).z();
    F_s = -guard(guards_.slave, -F_s, s.x_sd);
    return s.x_sd + Bench::kTs * step(mass_, v, along(F_s), F_e).z();
  }

 private:
  VirtualMassConfig mass_;
  FadeIn fade_in_;
  DampedMaster master_;
  DampedSlave slave_;
  Guards<ForceGuard> guards_;
};

// Wave variables. No guard around them: each receiver's energy limit already is one, and a guard
// that counts by the sign of the power at a port takes the waves' reflections for a debt.
class Wave : public Method {
 public:
  static constexpr double kStiffness = 20000;
  explicit Wave(const WaveConfig& c) : master_(c), slave_(c, kStiffness) {}

  void hear(const Message& m, bool at_master, TimePoint now) override {
    const WaveSum sum{along(m.U), m.E};
    const Duration sent(static_cast<Duration::rep>(m.sent)), at = now.time_since_epoch();
    at_master ? master_.push(sent, sum, at) : slave_.push(sent, sum, at);
  }
  void tell(Message& m, bool by_master) override {
    const WaveSum& sum = by_master ? master_.sum() : slave_.sum();
    m.U = sum.U.z(), m.E = sum.E;
  }
  double felt(const MasterView& m) override {
    return master_.step(along(m.v), m.now.time_since_epoch()).z();
  }
  double target(const SlaveView& s) override {
    const Vec3 v = along(s.v_sd), F_s = slave_.step(v, s.now.time_since_epoch());
    return s.x_sd + Bench::kTs * step(VirtualMassConfig{}, v, F_s, along(s.F_e)).z();
  }
  double playout() const { return (master_.playout() + slave_.playout()) / 2; }

 private:
  WaveMaster master_;
  WaveSlave slave_;
};

struct MediatedParts {
  WallFinderConfig finder;
  WallRendererConfig renderer;
};

// Model-mediated, under the operator's tank.
class Mediated : public Method {
 public:
  explicit Mediated(const MediatedParts& c = {})
      : finder_(c.finder), renderer_(c.renderer), tank_({}) {}

  void tell(Message& m, bool by_master) override {
    if (by_master) m.F = F_.z();
    if (by_master) return;
    const LocalWall& w = finder_.wall();
    m.known = w.known, m.n = w.n.z(), m.x_w = w.x_w.z(), m.k = w.k, m.b = w.b;
    m.contacts = w.contacts, m.net = w.net;
  }
  double felt(const MasterView& m) override {
    LocalWall told;
    if (m.from.in == nullptr) renderer_.forget();
    if (const Message* in = m.from.in)
      told = {.known = in->known,
              .x_w = along(in->x_w),
              .n = along(in->n),
              .k = in->k,
              .b = in->b,
              .contacts = in->contacts,
              .net = in->net};
    const OperatorAllowance allowed = tank_.step(F_, along(m.x), told.net, told.contacts);
    F_ = renderer_.step(along(m.x), along(m.v), told, allowed);
    low_ += allowed.share < 1;
    return F_.z();
  }
  double target(const SlaveView& s) override {
    if (!s.from.in) return finder_.forget(), s.x_sd;
    const Vec3 x_sd = along(s.x_sd), v = along(s.v), F_e = along(s.F_e);
    const double wish =
        finder_.step(along(reckon(s)), along(s.from.in->F), x_sd, along(s.x), v, F_e).z();
    constexpr double kFastest = 0.5;  // [m/s] as the workspace limits the target
    const double step = kFastest * Bench::kTs;
    return std::clamp(wish, s.x_sd - step, s.x_sd + step);
  }
  const WallFinder& finder() const { return finder_; }
  const WallRenderer& renderer() const { return renderer_; }
  long low() const { return low_; }

 private:
  WallFinder finder_;
  WallRenderer renderer_;
  OperatorTank tank_;
  Vec3 F_ = Vec3::Zero();
  long low_ = 0;
};

// Smith predictor, under a guard at the operator's port alone: what comes out there went in there.
class Smith : public Method {
 public:
  explicit Smith(const SmithConfig& c) : predictor_(c), poses_({}) {}

  void hear(const Message& m, bool at_master, TimePoint now) override {
    if (at_master) return;
    poses_.push(Duration(static_cast<Duration::rep>(m.sent)), along(m.x), now.time_since_epoch());
  }
  void tell(Message& m, bool by_master) override {
    if (!by_master) m.acted = static_cast<std::uint64_t>(poses_.given().count());
  }
  double felt(const MasterView& m) override {
    if (!m.from.in) return 0;
    const TimePoint acted{Duration(static_cast<Duration::rep>(m.from.in->acted))};
    const Vec3 F = predictor_.step(along(m.x), along(m.v), along(m.from.in->F), acted, m.now);
    guard_.budget().receive(guard_.budget().in());
    return guard_.step(F, along(m.x)).z();
  }
  double target(const SlaveView& s) override {
    return poses_.play(s.now.time_since_epoch(), along(s.x_sd)).z();
  }

 private:
  SmithPredictor predictor_;
  ForceGuard guard_{ForceGuardConfig{}};
  Playout<Vec3> poses_;
};

// No compensation: the robot is where the handle was, the hand feels what the robot felt.
class Direct : public Guarded {
 public:
  Direct(double share, bool on) : Guarded(on), share_(share), on_(on) {}

  void hear(const Message& m, bool at_master, TimePoint) override { guards_.hear(m, at_master); }
  void tell(Message& m, bool by_master) override { guards_.tell(m, by_master); }

  double felt(const MasterView& m) override {
    const double F = m.from.in ? share_ * fade({}, m.from.age) * m.from.in->F : 0;
    return guard(guards_.master, F, m.x);
  }
  double target(const SlaveView& s) override {
    if (!s.from.in) return s.x_sd;
    const double x = reckon(s), v = (x - (on_ ? x_ : s.x_sd)) / Bench::kTs;
    x_ = x;
    return s.x_sd + Bench::kTs * guard(guards_.slave, v, x - s.x_sd - v * Bench::kTs, s.F_e);
  }

 private:
  double share_;
  bool on_;
  double x_ = 0;
  Guards<VelocityGuard> guards_;
};

}  // namespace farhand::bench
