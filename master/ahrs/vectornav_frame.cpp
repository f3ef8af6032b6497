#include <bit>

#include "master/ahrs/float_bytes.hpp"
#include "master/ahrs/frame_formats.hpp"

namespace farhand {
namespace {

constexpr std::byte kSync{0xfa}, kCommonGroup{0x01};
constexpr std::size_t kHeaderBytes = 4, kCrcBytes = 2;

// Fields of the common group by their bit, and how many bytes each has.
enum Field : unsigned {
  kTimeStartup = 0,
  kQuaternion = 4,
  kAngularRate = 5,
  kAcceleration = 8,
  kImu = 9,      // uncompensated acceleration, then angular rate
  kMagPres = 10  // magnetic field, temperature, pressure
};
constexpr std::array<std::uint8_t, 15> kFieldBytes{8,  8,  8,  12, 16, 12, 24, 12,
                                                   12, 24, 20, 28, 2,  4,  8};

constexpr bool has(unsigned fields, Field f) noexcept {
  return (fields >> f & 1) != 0;
}

// Of all fields below this bit.
std::size_t bytes_below(unsigned fields, std::size_t bit) noexcept {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < bit; ++i)
    if (fields >> i & 1) sum += kFieldBytes[i];
  return sum;
}

// CRC-16, polynomial 0x1021 from 0, most significant bit first.
unsigned crc16(Bytes bytes) noexcept {
  unsigned crc = 0;
  for (const std::byte b : bytes) {
    crc ^= std::to_integer<unsigned>(b) << 8;
    for (int i = 0; i < 8; ++i) crc = (crc << 1 ^ (crc & 0x8000 ? 0x1021u : 0u)) & 0xffff;
  }
  return crc;
}

std::optional<AhrsSample> read(const std::byte* payload, unsigned fields) noexcept {
  const auto at = [&](Field f) { return payload + bytes_below(fields, f); };
  AhrsSample s;
  if (has(fields, kAngularRate) && has(fields, kAcceleration)) {
    s.gyro = load_vec3(at(kAngularRate));
    s.acceleration = load_vec3(at(kAcceleration));
  } else if (has(fields, kImu)) {
    s.acceleration = load_vec3(at(kImu));
    s.gyro = load_vec3(at(kImu) + 12);
  } else {
    return {};
  }
  if (has(fields, kTimeStartup))
    s.time = device_time(load_little_endian<std::uint64_t>(at(kTimeStartup)), 1);
  if (has(fields, kMagPres)) s.magnetic = kTeslaPerGauss * load_vec3(at(kMagPres));
  if (const std::byte* q = at(kQuaternion); has(fields, kQuaternion))
    s.attitude = unit({load_float(q + 12), load_float(q), load_float(q + 4), load_float(q + 8)});
  return s;
}

}  // namespace

FrameScan scan_vectornav(Bytes held) noexcept {
  if (held[0] != kSync) return no_frame();
  if (held.size() > 1 && held[1] != kCommonGroup) return no_frame();
  if (held.size() < kHeaderBytes) return more_bytes();
  const unsigned fields = load_little_endian<std::uint16_t>(held.data() + 2);
  if (fields == 0 || fields >> kFieldBytes.size()) return no_frame();
  const std::size_t size = kHeaderBytes + bytes_below(fields, kFieldBytes.size()) + kCrcBytes;
  if (held.size() < size) return more_bytes();
  if (crc16(held.subspan(1, size - 1)) != 0) return no_frame();
  const auto sample = read(held.data() + kHeaderBytes, fields);
  return sample ? framed(size, *sample) : FrameScan{.kind = FrameScan::Kind::frame, .size = size};
}

std::size_t encode_vectornav(const AhrsSample& s, FrameBytes to) noexcept {
  unsigned fields = 1u << kAngularRate | 1u << kAcceleration;
  if (s.time) fields |= 1u << kTimeStartup;
  if (s.attitude) fields |= 1u << kQuaternion;
  if (s.magnetic) fields |= 1u << kMagPres;
  to[0] = kSync;
  to[1] = kCommonGroup;
  store_little_endian(static_cast<std::uint16_t>(fields), to.data() + 2);
  std::byte* at = to.data() + kHeaderBytes;
  if (s.time) {
    store_little_endian(static_cast<std::uint64_t>(s.time->count()), at);
    at += 8;
  }
  if (s.attitude) at = store_float(s.attitude->w(), store_vec3(s.attitude->vec(), at));
  at = store_vec3(s.acceleration, store_vec3(s.gyro, at));
  if (s.magnetic) {
    at = store_vec3(*s.magnetic / kTeslaPerGauss, at);
    at = store_float(101.325, store_float(25, at));
  }
  const auto size = static_cast<std::size_t>(at - to.data());
  const unsigned crc = crc16(to.subspan(1, size - 1));
  at[0] = static_cast<std::byte>(crc >> 8);
  at[1] = static_cast<std::byte>(crc & 0xff);
  return size + kCrcBytes;
}

}  // namespace farhand
