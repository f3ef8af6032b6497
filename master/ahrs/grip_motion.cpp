#include "master/ahrs/grip_motion.hpp"

#include <cmath>

#include "common/limits.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

constexpr Duration kDelayWindow = 10s;
constexpr double kArrivalShare = 0.1;  // of an arrival's jitter in the date
constexpr double kArrivalReach = 1.5;  // [periods] beyond it samples are missing
constexpr double kHalfBlock = 0.008;   // [s] of the encoders' acceleration
constexpr int kMostHalfBlock = 12;     // [ticks], so that the memory holds three blocks
constexpr double kRestRange = 3;       // of rest_turn, between the ends of what a gyroscope reads

Quat quaternion_of(const Vec3& r) noexcept {
  return Quat(rotation(r));
}

}  // namespace

GripMotion::GripMotion(const GripMotionConfig& config) noexcept
    : config_(config),
      filter_(config.attitude),
      observer_(config.observer),
      half_block_(
          std::min(static_cast<int>(std::lround(kHalfBlock / config.observer.Ts)), kMostHalfBlock)),
      delay_(kDelayWindow) {}

TimePoint GripMotion::date(const AhrsSample& sample, TimePoint arrived) noexcept {
  if (!sample.time) return date_by_arrival(arrived);
  const Duration delay = arrived.time_since_epoch() - *sample.time;
  if (*sample.time <= device_time_ || device_time_ < Duration::zero()) {
    delay_ = RecentMinimum(kDelayWindow);
    first_delay_ = delay;
  }
  device_time_ = *sample.time;
  delay_.add(device_time_, delay - first_delay_);
  return TimePoint(device_time_ + first_delay_ + delay_.minimum() - config_.latency);
}

TimePoint GripMotion::date_by_arrival(TimePoint arrived) const noexcept {
  const TimePoint at = arrived - config_.latency, expected = last_ + config_.period;
  const double late = seconds(at - expected);
  if (!started_ || std::abs(late) > kArrivalReach * seconds(config_.period)) return at;
  return std::min(expected + from_seconds(kArrivalShare * late), arrived);
}

void GripMotion::take(const AhrsSample& raw, TimePoint arrived) noexcept {
  AhrsSample sample = raw;
  sample.gyro = config_.R_HI * raw.gyro;
  sample.acceleration = config_.R_HI * config_.acceleration(raw.acceleration);
  if (raw.magnetic) sample.magnetic = config_.R_HI * config_.magnetic(*raw.magnetic);
  const TimePoint at = date(sample, arrived);
  if (started_ && at <= last_) return;
  if (upright_)
    turn(sample, at);
  else
    align(sample, at);
  started_ = true;
  last_ = at;
  gyro_H_ = sample.gyro;
}

void GripMotion::align(const AhrsSample& sample, TimePoint at) noexcept {
  Alignment& a = alignment_;
  if (a.count == 0 || at - last_ > config_.lost)
    a = {.begin = at, .least = sample.gyro, .most = sample.gyro};
  ++a.count;
  a.gyro += sample.gyro;
  a.force += sample.acceleration;
  a.magnetic += sample.magnetic.value_or(Vec3::Constant(NAN));
  a.least = a.least.cwiseMin(sample.gyro);
  a.most = a.most.cwiseMax(sample.gyro);
  if (seconds(at - a.begin) < config_.align_s) return;
  const Vec3 magnetic = a.magnetic / a.count;
  const bool at_rest = (a.most - a.least).maxCoeff() < kRestRange * config_.attitude.rest_turn;
  filter_.start(a.force, a.gyro / a.count, at_rest, magnetic.allFinite() ? &magnetic : nullptr);
  upright_ = true;
}

void GripMotion::turn(const AhrsSample& sample, TimePoint at) noexcept {
  const double dt = seconds(at - last_);
  if (at - last_ <= config_.lost) filter_.turn((gyro_H_ + sample.gyro) / 2, dt);
  const Vec3 omega = sample.gyro - filter_.bias(), alpha = (sample.gyro - gyro_H_) / dt;
  const Vec3 swing = alpha.cross(config_.p_HI) + omega.cross(omega.cross(config_.p_HI));
  forces_[taken_++ % kForces] = {.at = at,
                                 .dt = std::min(dt, seconds(config_.coast)),
                                 .force_M = filter_.q_MH() * (sample.acceleration - swing)};
  if (sample.magnetic)
    turn_forces(
        filter_.correct_yaw(filter_.q_MH() * *sample.magnetic, forces_[(taken_ - 1) % kForces].dt));
}

const GripMotionEstimate& GripMotion::step(TimePoint now, const Vec3* p_MH) noexcept {
  given_.compared = false;
  if (p_MH != nullptr) {
    observer_.step(*p_MH);
    observe(now);
    compare(now);
    given_.X_MH.p = observer_.state().p;
    given_.V_MH.linear = observer_.state().v;
    given_.a_MH = observer_.state().a;
  } else {
    observer_.restart();
    observed_ = compared_ = taken_;
    given_.V_MH.linear.setZero();
    given_.a_MH.setZero();
  }
  orient(now);
  return given_;
}

// What came since the last tick is the grip's acceleration.
void GripMotion::observe(TimePoint now) noexcept {
  for (; observed_ < taken_; ++observed_) {
    if (filter_.tilt_sigma() > config_.sure_tilt) continue;
    const Force& f = force(observed_);
    observer_.acceleration(ticks(now - f.at), f.force_M - kGravity * config_.attitude.up_M);
  }
}

// Once the encoders know what surrounds a sample, its force less their acceleration points up.
void GripMotion::compare(TimePoint now) noexcept {
  const int reach = 3 * half_block_ + 1;
  const double reach_s = (reach + 0.5) * config_.observer.Ts;
  compared_ = std::max(compared_, taken_ - std::min(taken_, kForces / 2));
  for (; compared_ < taken_; ++compared_) {
    const Force& f = force(compared_);
    const int middle = static_cast<int>(std::lround(ticks(now - f.at)));
    if (middle < reach || seconds(force(taken_ - 1).at - f.at) < reach_s) return;
    const auto force_M = smoothed_force(compared_, reach_s);
    if (!force_M || !observer_.remembers(middle + reach)) continue;
    given_.compared = true;
    given_.a_encoder_M = encoder_acceleration(middle);
    const Vec3 gravity = *force_M - given_.a_encoder_M;
    given_.disagreement_M = gravity - kGravity * config_.attitude.up_M;
    turn_forces(filter_.correct_tilt(gravity, f.dt));
  }
}

void GripMotion::turn_forces(const Quat& turn_M) noexcept {
  const Mat3 R = turn_M.toRotationMatrix();
  for (Force& f : forces_) f.force_M = R * f.force_M;
}

// Second difference of three means.
Vec3 GripMotion::encoder_acceleration(int middle) const noexcept {
  const int block = 2 * half_block_ + 1;
  Vec3 sum = Vec3::Zero();
  for (int i = -half_block_; i <= half_block_; ++i)
    sum += observer_.position(middle + block + i) - 2 * observer_.position(middle + i) +
           observer_.position(middle - block + i);
  const double apart = block * config_.observer.Ts;
  return sum / (block * apart * apart);
}

// The forces around a sample with the weights that this difference gives the acceleration: the
// quadratic B-spline of its blocks. Nothing when it has no neighbour on one side.
std::optional<Vec3> GripMotion::smoothed_force(std::uint64_t sample, double reach) const noexcept {
  Vec3 sum = Vec3::Zero();
  double weights = 0, sides[2] = {0, 0};
  for (std::uint64_t i = taken_ - std::min(taken_, kForces); i < taken_; ++i) {
    const double off = seconds(force(i).at - force(sample).at) / reach;  // -1 to 1
    const double x = std::abs(off);
    const double weight = x < 1.0 / 3 ? 2.0 / 3 - 2 * x * x : x < 1 ? (1 - x) * (1 - x) : 0;
    sum += weight * force(i).force_M;
    weights += weight;
    if (i != sample) sides[off > 0] += weight;
  }
  if (!(sides[0] > 0 && sides[1] > 0)) return {};
  return sum / weights;
}

void GripMotion::orient(TimePoint now) noexcept {
  const double Ts = config_.observer.Ts;
  given_.ahrs = !started_ ? AhrsState::absent : !upright_ ? AhrsState::aligning : AhrsState::ok;
  if (!upright_) return;
  const Duration age = now - last_;
  if (age > config_.lost) given_.ahrs = AhrsState::lost;
  if (age > config_.coast) filter_.missed(Ts, config_.lost_turn_rate);
  given_.tilt_sigma = filter_.tilt_sigma();
  given_.yaw_sigma = filter_.yaw_sigma();

  const double slowing = seconds(config_.lost - config_.coast);
  const double late = std::clamp(seconds(age - config_.coast), 0.0, slowing);
  const double rate = 1 - late / slowing;
  rate_ = std::min(rate, rate_ + Ts / slowing);
  const double turning = seconds(std::min(age, config_.coast)) + late * (1 + rate) / 2;
  const Vec3 omega_H = gyro_H_ - filter_.bias();
  const Quat target = filter_.q_MH() * quaternion_of(turning * omega_H);

  given_.V_MH.angular = rate_ * (given_.X_MH.R * omega_H);
  const Quat turned = quaternion_of(Ts * given_.V_MH.angular) * Quat(given_.X_MH.R);
  const Vec3 off = rotation_vector((target * turned.conjugate()).toRotationMatrix());
  const Quat back = quaternion_of(clamp_norm(off, config_.return_rate * Ts));
  given_.X_MH.R = (back * turned).normalized().toRotationMatrix();
}

}  // namespace farhand
