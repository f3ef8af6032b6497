#include <algorithm>
#include <iterator>

#include "common/crc32c.hpp"
#include "master/ahrs/float_bytes.hpp"
#include "master/ahrs/frame_formats.hpp"

namespace farhand {
namespace {

constexpr std::byte kBegin[] = {std::byte{0xa5}, std::byte{0x46}, std::byte{1}};  // 1: the version
constexpr std::size_t kFields = 3, kTime = 4, kGyro = 12, kAcceleration = 24, kRest = 36;
constexpr std::size_t kCrcBytes = 4;
enum Field : unsigned { kMagnetic = 1, kAttitude = 2, kAllFields = 3 };

std::size_t content_bytes(unsigned fields) noexcept {
  return kRest + (fields & kMagnetic ? 12u : 0u) + (fields & kAttitude ? 16u : 0u);
}

AhrsSample read(const std::byte* frame, unsigned fields) noexcept {
  AhrsSample s{.gyro = load_vec3(frame + kGyro), .acceleration = load_vec3(frame + kAcceleration)};
  s.time = device_time(load_little_endian<std::uint64_t>(frame + kTime), 1000);
  const std::byte* at = frame + kRest;
  if (fields & kMagnetic) s.magnetic = load_vec3(at), at += 12;
  if (fields & kAttitude)
    s.attitude =
        unit({load_float(at), load_float(at + 4), load_float(at + 8), load_float(at + 12)});
  return s;
}

}  // namespace

FrameScan scan_native(Bytes held) noexcept {
  for (std::size_t i = 0; i < std::size(kBegin); ++i) {
    if (i == held.size()) return more_bytes();
    if (held[i] != kBegin[i]) return no_frame();
  }
  if (held.size() <= kFields) return more_bytes();
  const auto fields = std::to_integer<unsigned>(held[kFields]);
  if (fields > kAllFields) return no_frame();
  const std::size_t content = content_bytes(fields);
  if (held.size() < content + kCrcBytes) return more_bytes();
  if (crc32c(held.first(content)) != load_little_endian<std::uint32_t>(held.data() + content))
    return no_frame();
  return framed(content + kCrcBytes, read(held.data(), fields));
}

std::size_t encode_native(const AhrsSample& s, FrameBytes to) noexcept {
  const unsigned fields = (s.magnetic ? kMagnetic : 0u) | (s.attitude ? kAttitude : 0u);
  std::copy(std::begin(kBegin), std::end(kBegin), to.begin());
  to[kFields] = static_cast<std::byte>(fields);
  const auto time =
      std::chrono::duration_cast<std::chrono::microseconds>(s.time.value_or(Duration{}));
  store_little_endian(static_cast<std::uint64_t>(time.count()), to.data() + kTime);
  std::byte* at = store_vec3(s.acceleration, store_vec3(s.gyro, to.data() + kGyro));
  if (s.magnetic) at = store_vec3(*s.magnetic, at);
  if (s.attitude) {
    at = store_float(s.attitude->w(), at);
    at = store_vec3(s.attitude->vec(), at);
  }
  const std::size_t content = content_bytes(fields);
  store_little_endian(crc32c(to.first(content)), at);
  return content + kCrcBytes;
}

}  // namespace farhand
