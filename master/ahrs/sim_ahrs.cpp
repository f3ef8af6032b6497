#include "master/ahrs/sim_ahrs.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {

namespace {

Vec3 normal(double sigma, Random& random) noexcept {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return sigma * Vec3(x, y, z);
}

}  // namespace

SimAhrs::Sensor::Sensor(const SensorError& error, double rate, Random& random) noexcept
    : error_(error),
      noise_(error.noise * std::sqrt(rate / 2)),
      walk_(error.walk / std::sqrt(rate)),
      offset_(normal(error.offset, random)),
      scale_(Vec3::Ones() + normal(error.scale, random)) {}

Vec3 SimAhrs::Sensor::read(const Vec3& truth, Random& random) noexcept {
  offset_ += normal(walk_, random);
  Vec3 out = scale_.cwiseProduct(truth) + offset_ + normal(noise_, random);
  if (error_.step > 0)
    for (double& x : out) x = error_.step * std::round(x / error_.step);
  return out;
}

SimAhrs::SimAhrs(const SimAhrsConfig& config, std::uint64_t seed) noexcept
    : config_(config),
      random_(seed),
      gyro_(config.gyro, config.rate, random_),
      acceleration_(config.acceleration, config.rate, random_),
      magnetic_(config.magnetic, config.rate, random_),
      period_(from_seconds(1 / config.rate)) {}

AhrsSample SimAhrs::sample(TimePoint now, const GripTruth& t) noexcept {
  const Mat3 R_IM = (t.R_MH * config_.R_HI).transpose();
  const Mat3 R_IH = config_.R_HI.transpose();
  const Vec3 swing = t.alpha_H.cross(config_.p_HI) + t.omega_H.cross(t.omega_H.cross(config_.p_HI));
  AhrsSample s{.gyro = gyro_.read(R_IH * t.omega_H, random_),
               .acceleration = acceleration_.read(
                   R_IM * (t.a_MH + kGravity * config_.up_M) + R_IH * swing, random_),
               .time = now - begin_};
  if (config_.magnetometer) s.magnetic = magnetic_.read(R_IM * config_.field_M, random_);
  if (config_.attitude) s.attitude = Quat(t.R_MH * config_.R_HI);
  return s;
}

void SimAhrs::advance(TimePoint now, const GripTruth& truth) noexcept {
  if (!started_) begin_ = next_ = now;
  started_ = true;
  if (now < next_) return;
  next_ += ((now - next_) / period_ + 1) * period_;
  const AhrsSample made = sample(now, truth);
  const double late = random_.uniform();
  if (random_.uniform() < config_.lost || count_ == line_.size()) return;
  Frame& frame = line_[(first_ + count_) % line_.size()];
  frame.due = now + config_.latency + from_seconds(late * seconds(config_.jitter));
  if (count_ > 0) frame.due = std::max(frame.due, line_[(first_ + count_ - 1) % line_.size()].due);
  frame.size = encode(made, config_.format, frame.bytes);
  ++count_;
}

std::span<const std::byte> SimAhrs::read(TimePoint now) noexcept {
  std::size_t size = 0;
  while (count_ > 0 && line_[first_].due <= now && size + line_[first_].size <= arrived_.size()) {
    const Frame& frame = line_[first_];
    std::copy_n(frame.bytes.begin(), frame.size, arrived_.begin() + size);
    size += frame.size;
    first_ = (first_ + 1) % line_.size();
    --count_;
  }
  return std::span(arrived_).first(size);
}

}  // namespace farhand
