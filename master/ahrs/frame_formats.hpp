// One format each: what the bytes held so far begin with.
#pragma once

#include "master/ahrs/frames.hpp"

namespace farhand {

struct FrameScan {
  enum class Kind : std::uint8_t { more, none, frame };
  Kind kind = Kind::none;  // more: these may begin a frame. none: the first byte begins none
  std::size_t size = 0;    // of the frame, its checksum right
  std::optional<AhrsSample> sample{};  // nothing: a frame of something else
};
inline FrameScan more_bytes() noexcept {
  return {.kind = FrameScan::Kind::more};
}
inline FrameScan no_frame() noexcept {
  return {.kind = FrameScan::Kind::none};
}

inline constexpr double kTeslaPerGauss = 1e-4;

using Bytes = std::span<const std::byte>;
using FrameBytes = std::span<std::byte, kMaxFrameBytes>;

// None reads beyond what is held; held is not empty.
FrameScan scan_native(Bytes held) noexcept;
FrameScan scan_vectornav(Bytes held) noexcept;
FrameScan scan_text(Bytes held) noexcept;

std::size_t encode_native(const AhrsSample& sample, FrameBytes to) noexcept;
std::size_t encode_vectornav(const AhrsSample& sample, FrameBytes to) noexcept;
std::size_t encode_text(const AhrsSample& sample, FrameBytes to) noexcept;

// A sample if it can be one.
inline FrameScan framed(std::size_t size, const AhrsSample& sample) noexcept {
  FrameScan out{.kind = FrameScan::Kind::frame, .size = size};
  if (plausible(sample)) out.sample = sample;
  return out;
}

// Of a clock that counts so many nanoseconds; nothing for what no device has lived, 146 years.
inline std::optional<Duration> device_time(std::uint64_t count,
                                           std::uint64_t nanoseconds) noexcept {
  if (count > (std::uint64_t{1} << 62) / nanoseconds) return {};
  return Duration(static_cast<Duration::rep>(count * nanoseconds));
}

// Unit length, or nothing for what is no attitude.
inline std::optional<Quat> unit(const Quat& q) noexcept {
  const double n = q.norm();
  if (!(n > 0.99 && n < 1.01)) return {};
  return Quat(q.w() / n, q.x() / n, q.y() / n, q.z() / n);
}

}  // namespace farhand
