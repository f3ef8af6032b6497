// Smith predictor (Smith 1957, Chem. Eng. Prog. 53, 217): a model of the robot's servo and of a
// registered wall runs where the handle is, and the delay is taken out of the loop as far as the
// model is right,
//
//   F = F_e(received) + kf (F_model(now) - F_model(then))
//
// "then" is the moment of the handle's pose that the received force answers, as the slave says, so
// the round trip need not be known nor be constant. It must be even on the way there: the slave
// takes poses through a playout buffer (common/playout.hpp).
//
// Model    M x'' = Kp (x_m - x) + Kd (v_m - v) - F,  F = max(0, ke (x - x_w) . n + be v . n) n
//
// Guaranteed by the guard at the operator's port alone (common/force_guard.hpp). With stamps in
// place of an assumed round trip an error of the model shows slowly, not as a loop of its own; a
// wall that the servo's lag makes ring without any delay (5000 N/m for Kp 20 kN/m) rings here too.
// For a robot and a wall that are known. Gaps: F_e is held while the model goes on; beyond the
// delay line's length the correction rests.
#pragma once

#include <array>
#include <cstddef>

#include "common/geometry.hpp"
#include "common/local_wall.hpp"
#include "common/time.hpp"

namespace farhand {

struct SmithConfig {
  double Ts = 0.001;
  double share = 1;                       // kf
  double mass = 2, Kp = 20000, Kd = 400;  // of the robot at the tool, as its servo makes it
  LocalWall wall;                         // registered; x_w, n, k, b of the wall alone
};

class SmithPredictor {
 public:
  explicit SmithPredictor(const SmithConfig& config) noexcept : config_(config) {}

  // Where the registered wall is from now on; nothing known: there is none.
  void place(const LocalWall& wall) noexcept { config_.wall = wall.known ? wall : LocalWall{}; }
  // The next step begins anew: the model robot rests where the handle is then.
  void restart() noexcept { started_ = false; }

  // Once per tick. x_m, v_m: handle; F_e: robot on environment, newest; acted: the own time of the
  // pose it answers. Returns the force of the handle on the coupling.
  Vec3 step(const Vec3& x_m, const Vec3& v_m, const Vec3& F_e, TimePoint acted,
            TimePoint now) noexcept;

 private:
  static constexpr std::size_t kLength = 1024;  // [ticks]
  void start(const Vec3& x_m) noexcept;
  Vec3 wall_force() const noexcept;
  void move(const Vec3& x_m, const Vec3& v_m) noexcept;
  Vec3 then(double ticks_ago) const noexcept;

  SmithConfig config_;
  bool started_ = false;
  Vec3 x_ = Vec3::Zero(), v_ = Vec3::Zero(), F_ = Vec3::Zero();
  std::array<Vec3, kLength> past_{};
  std::size_t next_ = 0, known_ = 0;
};

}  // namespace farhand
