// AHRS frames found in a byte stream that is cut anywhere, with anything in between. Three formats;
// deploy/docs/ahrs.md has their tables of bytes. No frame is believed without its checksum; a frame
// cut short or changed costs itself, never the one behind it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "master/ahrs/sample.hpp"

namespace farhand {

enum class AhrsFormat : std::uint8_t {
  native,     // Farhand's own: little-endian floats, CRC-32C
  vectornav,  // VectorNav's binary output, common group, CRC-16
  text,       // VectorNav's $VNIMU and $VNYMR sentences, checksum of 8 bits
};

inline constexpr std::size_t kMaxFrameBytes = 204;  // of any format

class AhrsParser {
 public:
  explicit AhrsParser(AhrsFormat format) noexcept : format_(format) {}

  // Takes bytes as they come. What does not fit pushes out the oldest, which counts as skipped.
  void push(std::span<const std::byte> bytes) noexcept;
  // The oldest sample not yet given. Call until nothing comes.
  std::optional<AhrsSample> next() noexcept;

  std::uint64_t samples() const noexcept { return samples_; }
  // Frames whose checksum was right and whose content was not that of a sample.
  std::uint64_t foreign() const noexcept { return foreign_; }
  std::uint64_t skipped() const noexcept { return skipped_; }  // bytes that were no frame's

 private:
  void drop(std::size_t count) noexcept;

  AhrsFormat format_;
  std::array<std::byte, 4 * kMaxFrameBytes> held_{};
  std::size_t size_ = 0;
  std::uint64_t samples_ = 0, foreign_ = 0, skipped_ = 0;
};

// One sample at a time from a parser that is fed when it has none: more() gives the bytes that have
// come.
template <typename More>
std::optional<AhrsSample> next_sample(AhrsParser& parser, const More& more) noexcept {
  if (const auto sample = parser.next()) return sample;
  parser.push(more());
  return parser.next();
}

// The sample as a frame, for simulated sensors and tests; bytes of `to` used. `text` writes $VNIMU,
// which has neither attitude nor time, with its digits; a missing field reads as zero there.
std::size_t encode(const AhrsSample& sample, AhrsFormat format,
                   std::span<std::byte, kMaxFrameBytes> to) noexcept;

}  // namespace farhand
