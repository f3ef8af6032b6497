#include "master/falcon_usb/device.hpp"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "common/newest.hpp"
#include "common/program.hpp"
#include "common/realtime.hpp"
#include "master/falcon_usb/advice.hpp"
#include "master/falcon_usb/usb_transport.hpp"

namespace farhand {

class FalconUsb::Shell {
 public:
  explicit Shell(FalconUsbConfig config)
      : firmware_(std::move(config.firmware)),
        transport_(config.serial),
        driver_(driver_config(config.driver)),
        stale_(config.driver.stale),
        thread_([this] { run(); }) {}
  ~Shell() {
    closing_.store(true, std::memory_order_relaxed);
    thread_.join();
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  HandleReading read(TimePoint now) noexcept {
    if (const Read* news = readings_.take()) last_ = *news;
    return now - last_.at > stale_ ? HandleReading{} : last_.reading;
  }
  void write(TimePoint now, const Vec6& tau) noexcept { torques_.put({now, tau}); }
  std::optional<std::string> advice() {
    const falcon_usb::DriverStatus* news = statuses_.take();
    if (news == nullptr) return {};
    if (told_ && news->phase == told_->phase && news->trouble == told_->trouble) return {};
    told_ = *news;
    return falcon_usb::advice(*told_);
  }

 private:
  struct Read {
    TimePoint at{};  // stale from the start
    HandleReading reading;
  };
  struct Torque {
    TimePoint at{};
    Vec6 tau = Vec6::Zero();
  };

  falcon_usb::DriverConfig driver_config(falcon_usb::DriverConfig c) const noexcept {
    c.pacing = falcon_usb::Pacing::device;
    c.firmware = firmware_;
    return c;
  }

  void run() {
    // Late torque is worse than a late tick; the loop refuses to go on where this is not permitted.
    schedule_fifo(kLoopPriority + 1);
    while (!driver_.closed()) turn();
  }
  void turn() {
    constexpr Duration kLongest = std::chrono::milliseconds(10);
    const TimePoint now = monotonic_now();
    if (closing_.load(std::memory_order_relaxed)) driver_.close(now);
    if (const Torque* torque = torques_.take()) driver_.write(torque->at, torque->tau);
    pump(transport_, driver_, now);
    readings_.put({now, driver_.read(now)});
    statuses_.put(driver_.status());
    transport_.wait(std::clamp(driver_.due(), now, now + kLongest) - now, now);
  }

  std::vector<std::byte> firmware_;
  falcon_usb::UsbTransport transport_;
  falcon_usb::Driver driver_;
  Duration stale_;
  Newest<Read> readings_;
  Newest<Torque> torques_;
  Newest<falcon_usb::DriverStatus> statuses_;
  Read last_;                                     // the loop's
  std::optional<falcon_usb::DriverStatus> told_;  // that of the thread that asks for advice
  std::atomic<bool> closing_{false};
  std::thread thread_;  // last, as it uses all of the above
};

FalconUsb::FalconUsb(FalconUsbConfig config) : shell_(std::make_shared<Shell>(std::move(config))) {}

HandleReading FalconUsb::read(TimePoint now) noexcept {
  return shell_->read(now);
}

void FalconUsb::write(TimePoint now, const Vec6& tau) noexcept {
  shell_->write(now, tau);
}

std::optional<std::string> FalconUsb::advice() {
  return shell_->advice();
}

}  // namespace farhand
