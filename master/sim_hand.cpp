#include "master/sim_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace farhand {
namespace {

using namespace std::chrono_literals;

constexpr Duration kCatchUp = 50ms;
constexpr Duration kSolveEvery = 2ms;
constexpr double kInward = 0.95;  // how far a stop may shorten the way from the middle
constexpr int kHalvings = 6;

// The axis turned out of z by the tilt (x, y), its twist about it, and their rates.
HandCourse course(const MotionSample& m, const Vec3& middle) noexcept {
  const double x = m.turn.x(), y = m.turn.y(), angle2 = x * x + y * y, angle = std::sqrt(angle2);
  const bool tiny = angle2 < 1e-8;
  const double c = std::cos(angle);
  const double s = tiny ? 1 - angle2 / 6 : std::sin(angle) / angle;
  const double growth = x * m.turn_rate.x() + y * m.turn_rate.y();  // angle * its rate
  const double s_rate = growth * (tiny ? -1.0 / 3 : (c - s) / angle2);
  return {.p = {middle + m.p, m.v},
          .axis = {Vec3(s * y, -s * x, c), Vec3(s_rate * y + s * m.turn_rate.y(),
                                                -s_rate * x - s * m.turn_rate.x(), -s * growth)},
          .twist = {m.turn.z(), m.turn_rate.z()}};
}

// Cubic Hermite between two courses `span` apart, at the share s of it.
template <typename T>
Course<T> between(const Course<T>& a, const Course<T>& b, double span, double s) noexcept {
  const double r = 1 - s;
  return {r * r * (1 + 2 * s) * a.x + s * s * (1 + 2 * r) * b.x +
              s * r * span * (r * a.rate - s * b.rate),
          6 * s * r / span * (b.x - a.x) + r * (1 - 3 * s) * a.rate + s * (1 - 3 * r) * b.rate};
}

HandCourse between(const HandCourse& a, const HandCourse& b, double span, double s,
                   bool rotates) noexcept {
  HandCourse out{.p = between(a.p, b.p, span, s)};
  if (!rotates) return out;
  out.axis = between(a.axis, b.axis, span, s);
  out.twist = between(a.twist, b.twist, span, s);
  return out;
}

double rounded(double x, double step) noexcept {
  return step > 0 ? step * std::round(x / step) : x;
}

void check_rate(double rate, const Plant& plant) {
  if (rate >= fastest(plant)) return;
  throw std::runtime_error("the simulated hand's springs need at least " +
                           std::to_string(std::ceil(fastest(plant))) +
                           " steps per second instead of " + std::to_string(rate) +
                           "; raise rate_hz, or make the hand softer or the device heavier");
}

}  // namespace

template <typename Geometry>
SimHand<Geometry>::SimHand(const Geometry& geometry, SimHandConfig config)
    : linkage_(geometry),
      config_(std::move(config)),
      plant_{.device = config_.device,
             .hand = config_.user ? config_.user->impedance : kNobody,
             .down_M = linkage_.down_M(),
             .rotates = linkage_.kRotates},
      middle_(config_.start_p_MH.value_or(linkage_.middle())),
      random_(config_.seed) {
  check_rate(config_.rate, plant_);
  truth_.state.p_MH = middle_;
  if (!linkage_.solve(truth_.state))
    throw std::runtime_error(
        "the simulated hand starts outside the mechanism's workspace; leave start_position_m out "
        "or choose it nearer to the middle");
  last_inside_ = truth_.state;
  truth_.theta = linkage_.theta();
  if (config_.user) motion_.emplace(config_.user->motion);
  const std::uint64_t another_seed = ~config_.seed;
  if (config_.ahrs)
    ahrs_.emplace(Ahrs{SimAhrs(*config_.ahrs, another_seed), AhrsParser(config_.ahrs->format)});
  truth_.wish = wish_at(0);
}

template <typename Geometry>
HandleReading SimHand<Geometry>::read(TimePoint now) noexcept {
  advance(now);
  solve();
  HandleReading out{.ok = true,
                    .dead_man = pressed(Button::dead_man),
                    .clutch = pressed(Button::clutch),
                    .has_force = linkage_.kRotates && config_.force_sensor};
  for (int i = 0; i < linkage_.kMotors; ++i)
    out.theta[i] = rounded(truth_.theta[i], config_.encoder_step);
  if (out.has_force) out.ends = sense_ends();
  if (ahrs_) {
    truth_.grip = grip();
    ahrs_->sensor.advance(now, truth_.grip);
    out.ahrs = next_sample(ahrs_->parser, [&] { return ahrs_->sensor.read(now); });
  }
  return out;
}

template <typename Geometry>
void SimHand<Geometry>::write(TimePoint now, const Vec6& tau) noexcept {
  advance(now);
  truth_.tau.setZero();
  if (tau.allFinite()) {
    constexpr int kMotors = HandLinkage<Geometry>::kMotors;
    const double most = config_.motor_gain * tau.head<kMotors>().cwiseAbs().maxCoeff();
    const bool too_much = most > config_.max_motor_torque;
    const double share = config_.motor_gain * (too_much ? config_.max_motor_torque / most : 1);
    truth_.tau.template head<kMotors>() = share * tau.head<kMotors>();
    truth_.saturated += too_much;
  } else {
    ++truth_.bad_torque;
  }
  motors_ = linkage_.motors(truth_.tau);
}

template <typename Geometry>
void SimHand<Geometry>::turn(const Vec3& rate) noexcept {
  turned_ = turned_at(truth_.t);
  turning_since_ = truth_.t;
  turn_rate_ = rate;
}

template <typename Geometry>
void SimHand<Geometry>::advance(TimePoint now) noexcept {
  Duration left = std::max(now - now_.value_or(now), Duration::zero());
  now_ = now;
  if (left > kCatchUp) {
    left = kCatchUp;
    ++truth_.skipped;
  }
  while (left > Duration::zero()) {
    const Duration span = std::min(left, kSolveEvery);
    if (unsolved_ + span > kSolveEvery) solve();
    run(span);
    left -= span;
  }
}

// The plant over one span in equal steps, its motors' push held.
template <typename Geometry>
void SimHand<Geometry>::run(Duration span) noexcept {
  const double start = seconds(lived_), length = seconds(span);
  const long steps = std::max(1L, std::lround(length * config_.rate));
  const double h = length / static_cast<double>(steps);
  const HandCourse from = truth_.wish;
  lived_ += span;
  unsolved_ += span;
  truth_.t = seconds(lived_);
  const HandCourse to = wish_at(truth_.t);
  for (long i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    const Vec3 v = truth_.state.v_MH;
    const HandCourse wish = between(from, to, length, share, plant_.rotates);
    truth_.user = step(plant_, truth_.state, wish, motors_, push_at(start + share * length), h);
    a_MH_ = (truth_.state.v_MH - v) / h;
  }
  truth_.wish = to;
  if (std::abs(truth_.state.twist) > linkage_.kMaxTwist) {
    truth_.state.twist = std::copysign(linkage_.kMaxTwist, truth_.state.twist);
    truth_.state.twist_rate = 0;
    ++truth_.stops;
  }
}

template <typename Geometry>
void SimHand<Geometry>::solve() noexcept {
  if (unsolved_ == Duration::zero()) return;
  unsolved_ = Duration::zero();
  if (!linkage_.solve(truth_.state)) {
    ++truth_.stops;
    if (!stop_at_edge()) {
      truth_.state = last_inside_;
      truth_.state.v_MH.setZero();
      truth_.state.omega_M.setZero();
      truth_.state.twist_rate = 0;
    }
  }
  last_inside_ = truth_.state;
  truth_.theta = linkage_.theta();
  motors_ = linkage_.motors(truth_.tau);
}

// Undoes as little as puts the handle back inside: the turn, or else the last bit of the way from
// the middle, with the speed along it. False: neither is enough.
template <typename Geometry>
bool SimHand<Geometry>::stop_at_edge() noexcept {
  HandState& state = truth_.state;
  HandState unturned = last_inside_;
  unturned.p_MH = state.p_MH;
  unturned.v_MH = state.v_MH;
  unturned.omega_M.setZero();
  unturned.twist_rate = 0;
  if (plant_.rotates && linkage_.solve(unturned)) {
    state = unturned;
    return true;
  }
  const Vec3 way = state.p_MH - linkage_.middle();
  const auto shortened = [&](double share) {
    HandState s = state;
    s.p_MH = linkage_.middle() + share * way;
    return s;
  };
  double low = kInward, high = 1;
  if (!linkage_.solve(shortened(low))) return false;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (linkage_.solve(shortened(middle)) ? low : high) = middle;
  }
  state = shortened(low);
  const Vec3 out = way.normalized();
  state.v_MH -= std::max(0.0, state.v_MH.dot(out)) * out;
  return linkage_.solve(state);
}

template <typename Geometry>
HandCourse SimHand<Geometry>::wish_at(double t) const noexcept {
  if (motion_) {
    MotionSample wish = motion_->at(t);
    wish.turn += turned_at(t);
    wish.turn_rate += turn_rate_;
    return course(wish, middle_);
  }
  const HandState& s = truth_.state;
  return {.p = {s.p_MH, Vec3::Zero()}, .axis = {s.axis_M, Vec3::Zero()}, .twist = {s.twist, 0}};
}

template <typename Geometry>
Vec3 SimHand<Geometry>::push_at(double t) const noexcept {
  Vec3 force = Vec3::Zero();
  for (const Push& push : config_.pushes)
    if (t > push.at && t < push.at + push.lasting)
      force += std::sin(std::numbers::pi * (t - push.at) / push.lasting) * push.force;
  return force;
}

template <typename Geometry>
bool SimHand<Geometry>::pressed(Button button) const noexcept {
  return std::any_of(config_.presses.begin(), config_.presses.end(), [&](const Press& p) {
    return p.button == button && truth_.t >= p.at && truth_.t < p.at + p.lasting;
  });
}

template <typename Geometry>
Mat3 SimHand<Geometry>::wrist_at(double t) const noexcept {
  return motion_ ? rotation(motion_->at(t).turn + turned_at(t)) : Mat3(Mat3::Identity());
}

template <typename Geometry>
GripTruth SimHand<Geometry>::grip() const noexcept {
  constexpr double kStep = 1e-3;  // [s]
  const Mat3 before = wrist_at(truth_.t - kStep), now = wrist_at(truth_.t),
             after = wrist_at(truth_.t + kStep);
  const Vec3 to = rotation_vector(before.transpose() * now) / kStep;
  const Vec3 from = rotation_vector(now.transpose() * after) / kStep;
  return {.R_MH = now, .omega_H = (to + from) / 2, .alpha_H = (from - to) / kStep, .a_MH = a_MH_};
}

template <typename Geometry>
EndForces SimHand<Geometry>::sense_ends() noexcept {
  EndForces ends = config_.sensor_bias;
  if constexpr (HandLinkage<Geometry>::kRotates) {
    const Mat3 R_GM = linkage_.R_MG().transpose();
    const Vec3 grip_M = config_.grip_mass * kGravity * plant_.down_M;
    Wrench F{.force = R_GM * (truth_.user.force + grip_M), .torque = R_GM * truth_.user.moment};
    F.torque.z() += truth_.user.twist;
    const EndForces felt = linkage_.ends(F);
    ends.f_E1_M += felt.f_E1_M;
    ends.f_E2_A2 += felt.f_E2_A2;
  }
  if (config_.force_noise > 0)
    for (Vec3* f : {&ends.f_E1_M, &ends.f_E2_A2})
      for (double& x : *f) x += config_.force_noise * random_.normal();
  return ends;
}

template class SimHand<FalconGeometry>;
template class SimHand<TwinDeltaGeometry>;

static_assert(HapticDevice<SimHand<FalconGeometry>>);
static_assert(HapticDevice<SimHand<TwinDeltaGeometry>>);

}  // namespace farhand
