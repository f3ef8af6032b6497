// Takes each tick's whole record out of the loop, which writes it in place: slot() and commit() are
// wait-free, a thread of its own feeds the sink. What the sink keeps (a summary, a file) is its own
// business and may allocate and block; a full queue costs records, counted, never a tick.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "common/spsc_queue.hpp"

namespace farhand {

template <typename Record>
class Recorder {
 public:
  using Sink = std::function<void(const Record&)>;

  // About four seconds of ticks at 1 kHz.
  static constexpr std::size_t kCapacity = 4096;

  explicit Recorder(Sink sink) : sink_(std::move(sink)), thread_([this] { drain(); }) {}
  ~Recorder() { stop(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // From the loop only: where to write the next record, over an old one, and that it is written.
  // When the queue is full it goes nowhere and is counted.
  Record& slot() noexcept {
    slot_ = queue_.slot();
    return slot_ != nullptr ? *slot_ : spare_;
  }
  void commit() noexcept {
    if (slot_ != nullptr)
      queue_.commit();
    else
      lost_.fetch_add(1, std::memory_order_relaxed);
  }

  // Delivers what is queued and ends the thread; the sink may be read afterwards.
  void stop() {
    stop_.store(true, std::memory_order_release);
    if (thread_.joinable()) thread_.join();
  }

  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  void drain() {
    for (;;) {
      const bool last_round = stop_.load(std::memory_order_acquire);
      while (const Record* record = queue_.front()) {
        sink_(*record);
        queue_.pop();
      }
      if (last_round) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  SpscQueue<Record> queue_{kCapacity};
  Record* slot_ = nullptr;
  Record spare_{};
  Sink sink_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> lost_{0};
  std::thread thread_;
};

}  // namespace farhand
