#include "master/ahrs/grip_motion.hpp"

#include <cmath>

namespace farhand {
namespace {

using namespace std::chrono_literals;

constexpr Duration kDelayWindow = 10s;
constexpr double kArrivalShare = 0.1;  // of an arrival's jitter in the date
constexpr double kArrivalReach = 1.5;  // [periods] beyond it samples are missing
constexpr double kHalfBlock = 0.008;   // [s] of the encoders' acceleration
constexpr int kMostHalfBlock = 12;     // [ticks], so that the memory holds three blocks
constexpr double kRestRange = 3;       // of rest_turn, between the ends of what a gyroscope reads

Quat turned_by(const Vec3& r) noexcept {
  return Quat(rotation(r));
}

}  // namespace

GripMotion::GripMotion(const GripMotionConfig& config) noexcept
    : config_(config),
      filter_(config.attitude),
      observer_(config.observer),
      half_block_(std::min(static_cast<int>(std::lround(kHalfBlock / config.observer.Ts)),
                           kMostHalfBlock)),
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
  if (a.count == 0 || at - last_ > config_.lost) a = {.begin = at, .least = sample.gyro, .most = sample.gyro};
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
  returned_ = true;
}

void GripMotion::turn(const AhrsSample& sample, TimePoint at) noexcept {
  const double dt = seconds(at - last_);
  returned_ = returned_ || at - last_ > config_.coast;
  if (at - last_ <= config_.lost) filter_.turn((gyro_H_ + sample.gyro) / 2, dt);
  const Vec3 omega = sample.gyro - filter_.bias(), alpha = (sample.gyro - gyro_H_) / dt;
  const Vec3 swing = alpha.cross(config_.p_HI) + omega.cross(omega.cross(config_.p_HI));
  if (waiting_count_ == waiting_.size()) {
    first_ = (first_ + 1) % waiting_.size();
    --waiting_count_;
    observed_ -= observed_ > 0;
  }
  waiting_[(first_ + waiting_count_++) % waiting_.size()] = {
      .at = at, .dt = dt, .force_M = filter_.q_MH() * (sample.acceleration - swing)};
  if (sample.magnetic) filter_.correct_yaw(filter_.q_MH() * *sample.magnetic, dt);
}

const GripMotionEstimate& GripMotion::step(TimePoint now, const Vec3* p_MH) noexcept {
  given_.compared = false;
  if (p_MH != nullptr) {
    observer_.step(*p_MH);
    observe(now);
    correct_tilt(now);
    given_.X_MH.p = observer_.state().p;
    given_.V_MH.linear = observer_.state().v;
    given_.a_MH = observer_.state().a;
  } else {
    observer_.restart();
    waiting_count_ = observed_ = 0;
    given_.V_MH.linear.setZero();
    given_.a_MH.setZero();
  }
  orient(now);
  return given_;
}

// What came since the last tick is the grip's acceleration.
void GripMotion::observe(TimePoint now) noexcept {
  for (; observed_ < waiting_count_; ++observed_) {
    const Waiting& w = waiting_[(first_ + observed_) % waiting_.size()];
    observer_.acceleration(ticks(now - w.at), w.force_M - kGravity * config_.attitude.up_M);
  }
}

// The encoders' acceleration: second difference of three means, in M, around the sample's instant.
void GripMotion::correct_tilt(TimePoint now) noexcept {
  const int block = 2 * half_block_ + 1, reach = block + half_block_;
  for (; waiting_count_ > 0; --waiting_count_, --observed_) {
    const Waiting& w = waiting_[first_];
    const int middle = static_cast<int>(std::lround(ticks(now - w.at)));
    if (middle < reach) return;
    first_ = (first_ + 1) % waiting_.size();
    if (!observer_.remembers(middle + reach)) continue;
    Vec3 sum = Vec3::Zero();
    for (int i = -half_block_; i <= half_block_; ++i)
      sum += observer_.position(middle + block + i) - 2 * observer_.position(middle + i) +
             observer_.position(middle - block + i);
    const double apart = block * config_.observer.Ts;
    given_.compared = true;
    given_.a_encoder_M = sum / (block * apart * apart);
    const Vec3 gravity = w.force_M - given_.a_encoder_M;
    given_.disagreement_M = gravity - kGravity * config_.attitude.up_M;
    filter_.correct_tilt(gravity, w.dt);
  }
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
  const double turning = seconds(std::min(age, config_.coast)) + late * (1 + rate) / 2;
  const Vec3 omega_H = gyro_H_ - filter_.bias();
  const Quat target = filter_.q_MH() * turned_by(turning * omega_H);

  if (returned_) offset_ = Quat(given_.X_MH.R) * target.conjugate();
  returned_ = false;
  const Vec3 off = rotation_vector(offset_.toRotationMatrix());
  const double angle = off.norm();
  const double back = std::min(angle, config_.return_rate * Ts);
  given_.V_MH.angular = rate * (target * omega_H);
  if (angle > 0) {
    offset_ = turned_by(off * ((angle - back) / angle));
    given_.V_MH.angular -= off * (back / (angle * Ts));
  }
  given_.X_MH.R = (offset_ * target).normalized().toRotationMatrix();
}

}  // namespace farhand
