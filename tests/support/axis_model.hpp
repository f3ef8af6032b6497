// One axis of the teleoperation as the reference's single-axis model has it (section 9.3), around
// the product's own force controller, which drives the z axis of M:
//
//   (m_d + m_u) x'' = F_c - B x' - F_k tanh(x'/0.005) - F_g + u,   F_c = k_u (x_d - x) + b_u (x_d'
//   - x') F_u = F_c - m_u x'' robot  y'' = w^2 (x_delayed - y) - 2 z w y' - F_env / 10 kg wall
//   F_env = max(0, k_e (y - x_w) + b_e y') for y > x_w, or without the max and the if
//
// with semi-implicit Euler substeps. Between them and the controller: force noise, encoder steps,
// a queue before the motors, poles of motor and sensor, whole ticks of network each way.
#pragma once

#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>

#include "common/pid.hpp"
#include "common/random.hpp"
#include "master/force_controller.hpp"
#include "tests/support/periodic.hpp"

namespace farhand::axis {

struct Device {
  double m = 1.0, B = 4, F_k = 0.8, F_g = 2.0;
};
struct Hand {
  double m = 0.4, k = 500, b = 20;
};
struct Robot {
  double hz = 6, zeta = 0.9, mass = 10;
};
struct Wall {
  double x = 0.03, k = 500, b = 5;
  bool bilateral = false;
};
struct Wish {
  double x = 0, rate = 0;
};

struct LoopConfig {
  Device device;
  Hand hand;
  Robot robot;
  std::optional<Wall> wall{};  // without: free motion, no robot
  int delay = 2;               // ticks of network, each way
  int queue = 1;               // ticks from a command to its push
  double motor_hz = 0;         // pole of the motors; 0: none
  double sensor_hz = 0;        // pole of the force sensor; 0: none
  double force_noise = 0;      // [N] standard deviation
  double encoder_step = 0;     // [m]
  double command_gain = 1;     // of the whole command, to find its margin
  double Ts = 0.001;
  int substeps = 10;
  std::uint64_t seed = 1;
  ForceControllerConfig controller{};
};

// After a tick's period.
struct Tick {
  double t = 0;
  double x = 0, v = 0;
  double y = 0;           // of the robot
  double F_u = 0;         // true
  double F_measured = 0;  // as the controller got it at the end of the period before
  double F_e = 0;         // likewise
  double F_env = 0;       // of the robot, undelayed
  double u = 0;           // that acted
};

// What came in `ticks` ago, 0 before anything did.
class Delay {
 public:
  explicit Delay(int ticks) : line_(static_cast<std::size_t>(ticks), 0.0) {}
  double operator()(double in) {
    line_.push_back(in);
    const double out = line_.front();
    line_.pop_front();
    return out;
  }

 private:
  std::deque<double> line_;
};

class Loop {
 public:
  explicit Loop(const LoopConfig& c)
      : c_(c),
        controller_(c.controller, c.Ts),
        random_(c.seed),
        queue_(c.queue),
        to_robot_(c.delay),
        to_handle_(c.delay),
        motor_gain_(low_pass_gain(c.motor_hz, c.Ts / c.substeps)),
        sensor_gain_(low_pass_gain(c.sensor_hz, c.Ts)) {
    handle_.status = Status::ok;
  }

  // One period under what the hand wishes, a function of time.
  template <typename F>
  const Tick& tick(F&& wish) {
    const double u = command();
    const double h = c_.Ts / c_.substeps;
    for (int i = 1; i <= c_.substeps; ++i) {
      motor_ += motor_gain_ * (u - motor_);
      move(wish(t_.t + i * h), h);
    }
    if (c_.wall) t_.F_env = press(to_robot_(t_.x));
    F_e_ = to_handle_(t_.F_env);
    t_.t += c_.Ts;
    return t_;
  }

  const Tick& last() const { return t_; }

 private:
  double command() {
    sensor_ += sensor_gain_ * (t_.F_u - sensor_);
    t_.F_measured = sensor_ + (c_.force_noise > 0 ? c_.force_noise * random_.normal() : 0);
    t_.F_e = F_e_;
    const double step = c_.encoder_step;
    handle_.X_MH.p.z() = step > 0 ? step * std::round(t_.x / step) : t_.x;
    const Wrench F_user{Vec3(0, 0, t_.F_measured), Vec3::Zero()};
    LimitSet set = 0;
    F_m_ = controller_.step({.F_env_G = {Vec3(0, 0, F_e_), Vec3::Zero()},
                             .F_user_G = &F_user,
                             .handle = &handle_,
                             .F_given_G = F_m_,
                             .engaged = true},
                            set);
    return t_.u = c_.command_gain * queue_(F_m_.force.z());
  }

  void move(const Wish& wish, double h) {
    const double F_c = c_.hand.k * (wish.x - t_.x) + c_.hand.b * (wish.rate - t_.v);
    const double a = (F_c - c_.device.B * t_.v - c_.device.F_k * std::tanh(t_.v / 0.005) -
                      c_.device.F_g + motor_) /
                     (c_.device.m + c_.hand.m);
    t_.v += h * a;
    t_.x += h * t_.v;
    t_.F_u = F_c - c_.hand.m * a;
  }

  double press(double x) {
    const double w = kTurn * c_.robot.hz, h = c_.Ts / c_.substeps;
    const auto force = [&] {
      const double F = c_.wall->k * (t_.y - c_.wall->x) + c_.wall->b * dy_;
      return c_.wall->bilateral ? F : t_.y > c_.wall->x ? std::max(0.0, F) : 0.0;
    };
    for (int i = 0; i < c_.substeps; ++i) {
      dy_ += h * (w * w * (x - t_.y) - 2 * c_.robot.zeta * w * dy_ - force() / c_.robot.mass);
      t_.y += h * dy_;
    }
    return force();
  }

  LoopConfig c_;
  ForceController controller_;
  Random random_;
  Delay queue_, to_robot_, to_handle_;
  double motor_gain_, sensor_gain_;
  HandlePose handle_;
  Wrench F_m_;
  double motor_ = 0, sensor_ = 0, F_e_ = 0, dy_ = 0;
  Tick t_;
};

// ---- the publication's wishes (reference section 10)

inline auto h1_wish(double hz = 1, double amplitude = 0.05) {
  return [w = kTurn * hz, amplitude](double t) {
    const double grow = std::min(1.0, t), s = std::sin(w * t), c = std::cos(w * t);
    return Wish{amplitude * s * grow, amplitude * (w * c * grow + (t < 1 ? s : 0))};
  };
}
inline Wish h2_wish(double t) {
  if (t < 10) return h1_wish(0.4, 0.03)(t);
  const double s = std::min(1.0, (t - 10) / 4), pi = std::numbers::pi;
  Wish w{0.03 * (1 - std::cos(pi * s)), s < 1 ? 0.03 * pi / 4 * std::sin(pi * s) : 0};
  if (t > 14) {
    const double v = kTurn * 0.5;
    w.x += 0.008 * std::sin(v * (t - 14)), w.rate += 0.008 * v * std::cos(v * (t - 14));
  }
  return w;
}

// F_u over the last `periods` of a wish of `hz` after `settle` seconds.
inline Swing swing(const LoopConfig& config, double hz, double amplitude, double settle,
                   int periods) {
  Loop loop(config);
  const auto wish = h1_wish(hz, amplitude);
  Periodic figures(std::lround(1 / (hz * config.Ts)), periods);
  while (loop.last().t < settle - config.Ts / 2) loop.tick(wish);
  while (!figures.complete()) {
    const Tick& t = loop.tick(wish);
    figures.add(t.F_u, t.x, t.F_measured);
  }
  return figures.swing();
}

}  // namespace farhand::axis
