// Bounded, wait-free queue for one producer and one consumer: the only road out of the loop. The
// storage is allocated once.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace farhand {

template <typename T>
class SpscQueue {
 public:
  // Holds at least `capacity` elements, rounded up to a power of two.
  explicit SpscQueue(std::size_t capacity) : slots_(std::bit_ceil(capacity < 2 ? 2 : capacity)) {}

  // Producer. Where the next element is to be written, over an old one; nullptr when full.
  T* slot() noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - known_tail_ == slots_.size()) {
      known_tail_ = tail_.load(std::memory_order_acquire);
      if (head - known_tail_ == slots_.size()) return nullptr;
    }
    return &slots_[head & (slots_.size() - 1)];
  }
  // Producer. Hands over what was written to the slot.
  void commit() noexcept {
    head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  // Consumer. The oldest element, or nullptr when empty; stays valid until pop().
  const T* front() noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == known_head_) {
      known_head_ = head_.load(std::memory_order_acquire);
      if (tail == known_head_) return nullptr;
    }
    return &slots_[tail & (slots_.size() - 1)];
  }
  void pop() noexcept {
    tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  std::size_t capacity() const noexcept { return slots_.size(); }

 private:
  static constexpr std::size_t kCacheLine = 64;
  std::vector<T> slots_;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};  // written by the producer
  std::size_t known_tail_ = 0;                            // the producer's copy of tail_
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};  // written by the consumer
  std::size_t known_head_ = 0;                            // the consumer's copy of head_
};

}  // namespace farhand
