// One axis of a teleoperation, for the compensation methods: a hand that wants to be somewhere, a
// device, two impaired networks with sealed messages, a robot behind a stiff position servo, and a
// wall.
//
//   m x_m'' = Kh (x_w - x_m) + Bh (v_w - v_m) - F          M x_s'' = Kp (x_sd - x_s) + Kd (v_sd -
//   v_s) - F_e F_e = max(0, ke (x_s - wall) + be v_s)
#pragma once

#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <vector>

#include "common/channel.hpp"
#include "common/impairment.hpp"
#include "common/pid.hpp"

namespace farhand::bench {

// What either side tells the other: absolute state and sums, newest wins.
struct Message {
  std::uint64_t sequence = 0, sent = 0, echo_sent = 0, acted = 0;
  double x = 0, v = 0, F = 0;
  bool coupled = true;  // the robot follows
  double energy = 0;    // that went into the network at the sender
  double U = 0, E = 0;  // integrals of the wave and its energy
  bool known = false;   // of the wall, as the slave believes: all below
  double x_w = 0, n = 0, k = 0, b = 0, net = 0;
  std::uint32_t contacts = 0;
};

struct Wall {
  double k = 1000, b = 5;
  std::function<double(double t)> x = [](double) { return 0.04; };
};
struct Hand {
  double k = 300, b = 10, mass = 0.5;
};
struct Robot {
  double Kp = 20000, Kd = 400, mass = 2;
};
struct Wish {
  double x = 0, v = 0;
};

// A link dead for so long ends the coupling; the hand takes it up again, from where it is, as with
// the clutch, when the link is back.
inline constexpr Duration kUncouple = std::chrono::milliseconds(500);

struct Rig {
  Hand hand{};
  Robot robot{};
  Wall wall{};
  std::optional<ImpairmentConfig> forward, backward;
  std::uint64_t seed = 1;
  double velocity_hz = 60;
  double hold = 4;                     // [s] pressed on the wall
  bool twice = false;                  // every datagram is delivered again, 7 ms later
  std::optional<double> plain_from{};  // [s] from then on the networks do nothing but delay
};

struct Inbox {
  const Message* in = nullptr;  // newest, nullptr before the first
  Duration age = Duration::max(), echo_age{};
};
struct MasterView {
  TimePoint now;
  double x = 0, v = 0;
  Inbox from;
};
struct SlaveView {
  TimePoint now;
  double x_sd = 0, v_sd = 0;  // told in the last tick
  double x = 0, v = 0, F_e = 0;
  Inbox from;
};

// A method under test, both halves; one axis of it, z.
class Method {
 public:
  virtual ~Method() = default;
  virtual void hear(const Message&, bool /*at_master*/, TimePoint /*now*/) {
  }                                             // all that come, in any order
  virtual double felt(const MasterView&) = 0;   // force of the handle
  virtual double target(const SlaveView&) = 0;  // x_sd
  virtual void tell(Message&, bool /*by_master*/) {}
};

struct Sample {
  double t = 0, wish = 0, x_m = 0, v_m = 0, F = 0, x_s = 0, v_s = 0, x_sd = 0, F_e = 0;
  double energy = 0, operator_energy = 0;  // that went into the network, both ports; at the hand
};

class Direction {
 public:
  static constexpr std::size_t kUnderWay = 1024;  // datagrams
  Direction(const std::optional<ImpairmentConfig>& config, const Rig& s, std::uint64_t seed)
      : network_(config, seed, kUnderWay), plain_from_(from_seconds(s.plain_from.value_or(1e6))) {
    if (s.plain_from)
      plain_.emplace(ImpairmentConfig{.delay_ms = config->delay_ms}, seed, kUnderWay);
    if (s.twice) again_.emplace(ImpairmentConfig{.delay_ms = 7}, seed, kUnderWay);
  }

  void send(Message m, TimePoint now) {
    std::array<std::byte, sizeof(Message)> bytes;
    std::array<std::byte, kMaxDatagramBytes> datagram;
    std::memcpy(bytes.data(), &m, sizeof m);
    const std::size_t n = seal(bytes, datagram);
    (now < plain_from_ ? network_ : *plain_).push(std::span(datagram).first(n), now);
  }
  template <typename F>
  void receive(TimePoint now, F&& use) {
    std::array<std::byte, kMaxDatagramBytes> datagram;
    while (true) {
      auto got = network_.pop(now, datagram);
      if (got.empty() && plain_) got = plain_->pop(now, datagram);
      const bool second = got.empty();
      if (second && again_) got = again_->pop(now, datagram);
      if (got.empty()) return;
      if (again_ && !second) again_->push(got, now);
      std::array<std::byte, kMaxPayloadBytes> payload;
      const Opened opened = open(got, payload);
      if (opened.verdict != Verdict::accepted || opened.size != sizeof(Message)) continue;
      Message m;
      std::memcpy(&m, payload.data(), sizeof m);
      use(m);
    }
  }

 private:
  Impairment network_;
  std::optional<Impairment> plain_, again_;
  TimePoint plain_from_;
};

// The newest of what came, and its ages.
class Box {
 public:
  void take(const Message& m, TimePoint now) {
    if (m.sequence <= newest_.sequence) return;
    newest_ = m, arrived_ = now;
  }
  Inbox look(TimePoint now) const {
    if (newest_.sequence == 0) return {.echo_age = now.time_since_epoch()};
    const bool coupled = newest_.coupled && now - arrived_ < kUncouple;
    return {coupled ? &newest_ : nullptr, now - arrived_,
            now.time_since_epoch() - Duration(static_cast<Duration::rep>(newest_.echo_sent))};
  }
  std::uint64_t stamp() const { return newest_.sent; }

 private:
  Message newest_;
  TimePoint arrived_;
};

class Bench {
 public:
  static constexpr double kTs = 0.001;
  static constexpr int kSubsteps = 4;

  Bench(const Rig& rig, Method& method)
      : s_(rig),
        method_(method),
        up_(rig.forward, rig, 2 * rig.seed),
        down_(rig.backward, rig, 2 * rig.seed + 1),
        velocity_gain_(low_pass_gain(rig.velocity_hz, kTs)) {}

  const Sample& tick(const Wish& wish, const Wish& next) {
    const TimePoint now{from_seconds(a_.t)};
    v_f_ += velocity_gain_ * ((a_.x_m - x_m_) / kTs - v_f_);
    x_m_ = a_.x_m;
    send(up_, {.x = a_.x_m, .v = v_f_}, true, now, in_m_);
    up_.receive(now, [&](Message m) {
      if (!coupled_ && m.sequence > 0) offset_ = m.x - a_.x_sd, coupled_ = true;
      m.x -= offset_;
      in_s_.take(m, now), method_.hear(m, false, now);
    });
    coupled_ = coupled_ && (in_s_.look(now).in != nullptr || in_s_.stamp() == 0);
    const double x_sd = method_.target({.now = now,
                                        .x_sd = a_.x_sd,
                                        .v_sd = v_sd_,
                                        .x = a_.x_s,
                                        .v = a_.v_s,
                                        .F_e = a_.F_e,
                                        .from = in_s_.look(now)});
    v_sd_ = (x_sd - a_.x_sd) / kTs;
    a_.energy -= a_.F_e * (x_sd - a_.x_sd);
    send(down_, {.x = a_.x_s, .v = a_.v_s, .F = a_.F_e}, false, now, in_s_);
    down_.receive(now, [&](const Message& m) { in_m_.take(m, now), method_.hear(m, true, now); });
    a_.F = method_.felt({.now = now, .x = a_.x_m, .v = v_f_, .from = in_m_.look(now)});
    const double x_before = a_.x_m, sd_before = a_.x_sd;
    for (int i = 1; i <= kSubsteps; ++i) {
      const double part = static_cast<double>(i) / kSubsteps, h = kTs / kSubsteps;
      const Wish w{wish.x + part * (next.x - wish.x), next.v};
      move_hand(w, h);
      move_robot(sd_before + part * (x_sd - sd_before), h);
    }
    a_.x_sd = x_sd;
    a_.energy += a_.F * (a_.x_m - x_before);
    a_.operator_energy += a_.F * (a_.x_m - x_before);
    a_.wish = next.x;
    a_.t += kTs;
    return a_;
  }

 private:
  void send(Direction& to, Message m, bool by_master, TimePoint now, const Box& from) {
    m.sequence = by_master ? ++sent_m_ : ++sent_s_;
    m.sent = static_cast<std::uint64_t>(now.time_since_epoch().count());
    m.echo_sent = from.stamp();
    method_.tell(m, by_master);
    if (!by_master) m.x += offset_, m.x_w += offset_, m.coupled = coupled_;
    to.send(m, now);
  }
  void move_hand(const Wish& w, double h) {
    const double f = s_.hand.k * (w.x - a_.x_m) + s_.hand.b * (w.v - a_.v_m) - a_.F;
    a_.v_m += h / s_.hand.mass * f;
    a_.x_m += h * a_.v_m;
  }
  void move_robot(double x_sd, double h) {
    const double depth = a_.x_s - s_.wall.x(a_.t);
    a_.F_e = depth > 0 ? std::max(0.0, s_.wall.k * depth + s_.wall.b * a_.v_s) : 0;
    const double f = s_.robot.Kp * (x_sd - a_.x_s) + s_.robot.Kd * (v_sd_ - a_.v_s) - a_.F_e;
    a_.v_s += h / s_.robot.mass * f;
    a_.x_s += h * a_.v_s;
  }

  Rig s_;
  Method& method_;
  Direction up_, down_;
  Box in_m_, in_s_;
  double velocity_gain_, v_f_ = 0, x_m_ = 0, v_sd_ = 0;
  std::uint64_t sent_m_ = 0, sent_s_ = 0;
  bool coupled_ = true;
  double offset_ = 0;  // handle less robot where they mean the same
  Sample a_;
};

}  // namespace farhand::bench
