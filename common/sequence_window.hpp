// Which sequence numbers have arrived: the highest, and a bit for each of the kSpan behind it.
#pragma once

#include <array>
#include <cstdint>

namespace farhand {

class SequenceWindow {
 public:
  static constexpr std::uint64_t kSpan = 1024;  // one second at 1 kHz

  enum class Place : std::uint8_t {
    newest,     // above all before
    late,       // below the highest, first arrival
    duplicate,  // arrived before
    too_old,    // kSpan or more below the highest: nobody remembers
  };

  // Takes note of `sequence` and says where it stands. `skipped` grows by the numbers a newest one
  // jumps over and shrinks when one of them comes late; the first of all skips none.
  Place admit(std::uint64_t sequence) noexcept {
    if (empty_ || sequence > highest_) {
      advance(sequence);
      return Place::newest;
    }
    if (highest_ - sequence >= kSpan) return Place::too_old;
    std::uint64_t& word = seen_[index(sequence)];
    if ((word & bit(sequence)) != 0) return Place::duplicate;
    word |= bit(sequence);
    if (sequence > first_) --skipped_;
    return Place::late;
  }

  std::uint64_t highest() const noexcept { return highest_; }
  std::uint64_t skipped() const noexcept { return skipped_; }

 private:
  static constexpr std::uint64_t kBits = 64;
  static constexpr std::uint64_t kWords = kSpan / kBits + 1;  // one to spare: cleared while ahead

  static constexpr std::uint64_t bit(std::uint64_t sequence) noexcept {
    return std::uint64_t{1} << (sequence % kBits);
  }
  static constexpr std::uint64_t index(std::uint64_t sequence) noexcept {
    return sequence / kBits % kWords;
  }

  void advance(std::uint64_t sequence) noexcept {
    const std::uint64_t from = highest_ / kBits, words = empty_ ? 0 : sequence / kBits - from;
    for (std::uint64_t k = 1; k <= words && k <= kWords; ++k) seen_[(from + k) % kWords] = 0;
    if (empty_) first_ = sequence;
    if (!empty_) skipped_ += sequence - highest_ - 1;
    empty_ = false;
    highest_ = sequence;
    seen_[index(sequence)] |= bit(sequence);
  }

  std::array<std::uint64_t, kWords> seen_{};
  std::uint64_t highest_ = 0;
  std::uint64_t first_ = 0;
  std::uint64_t skipped_ = 0;
  bool empty_ = true;
};

}  // namespace farhand
