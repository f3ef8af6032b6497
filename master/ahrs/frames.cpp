#include "master/ahrs/frames.hpp"

#include <algorithm>

#include "master/ahrs/frame_formats.hpp"

namespace farhand {
namespace {

FrameScan scan(AhrsFormat format, Bytes held) noexcept {
  switch (format) {
    case AhrsFormat::native:
      return scan_native(held);
    case AhrsFormat::vectornav:
      return scan_vectornav(held);
    case AhrsFormat::text:
      return scan_text(held);
  }
  return no_frame();
}

}  // namespace

void AhrsParser::push(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() > held_.size()) {
    skipped_ += bytes.size() - held_.size();
    bytes = bytes.last(held_.size());
  }
  const std::size_t room = held_.size() - size_;
  if (bytes.size() > room) {
    skipped_ += bytes.size() - room;
    drop(bytes.size() - room);
  }
  std::copy(bytes.begin(), bytes.end(), held_.begin() + size_);
  size_ += bytes.size();
}

std::optional<AhrsSample> AhrsParser::next() noexcept {
  std::size_t at = 0;
  std::optional<AhrsSample> sample;
  while (at < size_ && !sample) {
    const FrameScan found = scan(format_, Bytes(held_).first(size_).subspan(at));
    if (found.kind == FrameScan::Kind::more) break;
    if (found.kind == FrameScan::Kind::none) ++at, ++skipped_;
    if (found.kind != FrameScan::Kind::frame) continue;
    at += found.size;
    sample = found.sample;
    ++(sample ? samples_ : foreign_);
  }
  drop(at);
  return sample;
}

void AhrsParser::drop(std::size_t count) noexcept {
  std::copy(held_.begin() + count, held_.begin() + size_, held_.begin());
  size_ -= count;
}

std::size_t encode(const AhrsSample& sample, AhrsFormat format,
                   std::span<std::byte, kMaxFrameBytes> to) noexcept {
  switch (format) {
    case AhrsFormat::native:
      return encode_native(sample, to);
    case AhrsFormat::vectornav:
      return encode_vectornav(sample, to);
    case AhrsFormat::text:
      return encode_text(sample, to);
  }
  return 0;
}

}  // namespace farhand
