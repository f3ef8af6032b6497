// A haptic device that answers with what another one was read as: one recorded reading after the
// other, whatever the time and the torque. After the last it is gone (not ok).
#pragma once

#include <memory>
#include <vector>

#include "master/haptic_device.hpp"

namespace farhand {

class ReplayHand {
 public:
  static constexpr bool kReal = false;

  explicit ReplayHand(std::vector<HandleReading> readings)
      : readings_(std::make_shared<const std::vector<HandleReading>>(std::move(readings))) {}

  HandleReading read(TimePoint) noexcept {
    return next_ < readings_->size() ? (*readings_)[next_++] : HandleReading{};
  }
  void write(TimePoint, const Vec6&) noexcept {}

  std::size_t size() const noexcept { return readings_->size(); }

 private:
  std::shared_ptr<const std::vector<HandleReading>> readings_;  // copies share them
  std::size_t next_ = 0;
};

static_assert(HapticDevice<ReplayHand>);

}  // namespace farhand
