// What the fuzz targets share: the fuzzer's bytes read piece by piece, and valid inputs made by the
// target itself, so that no corpus need be kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

extern "C" {
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t room);
std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t room,
                                    unsigned seed);
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
}

namespace farhand {

// What must hold, in every build.
inline void require(bool holds) {
  if (!holds) std::abort();
}

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size)
      : left_(reinterpret_cast<const std::byte*>(data), size) {}

  bool empty() const { return left_.empty(); }
  // 0 past the end.
  unsigned byte() { return left_.empty() ? 0 : std::to_integer<unsigned>(take(1)[0]); }
  unsigned number() { return byte() | byte() << 8; }
  // Fewer at the end.
  std::span<const std::byte> take(std::size_t n) {
    const auto taken = left_.first(std::min(n, left_.size()));
    left_ = left_.subspan(taken.size());
    return taken;
  }

 private:
  std::span<const std::byte> left_;
};

// Now and then the fuzzer goes on from a valid input instead of its own. Returns the size.
inline std::size_t mutate_or_restart(std::uint8_t* data, std::size_t size, std::size_t room,
                                     bool restart, const std::string& valid) {
  if (restart || size == 0) {
    size = std::min(valid.size(), room);
    std::copy_n(valid.begin(), size, data);
  }
  return LLVMFuzzerMutate(data, size, room);
}

}  // namespace farhand
