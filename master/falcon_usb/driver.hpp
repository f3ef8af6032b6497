// The Falcon behind a transport: from plugging in to torque, and back to none.
//
//   absent -> setting_up -> probing -> homing -> homed -> armed        closed
//                 ^            | no answer                 (by close(), from anywhere)
//                 +-uploading<-+            failed: until it is plugged in again, or, for want of
//                                           firmware, until it answers after all
//
// Torque leaves in `armed` alone. There it is zero when no answer was taken for `unanswered`, or no
// write came for `unwritten`. An axis that is not homed any more, or counts that jump, lead back to
// `homing`, silence to `setting_up`, and from each the way to `armed` is by the gesture.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "master/falcon_usb/arming.hpp"
#include "master/falcon_usb/counts.hpp"
#include "master/falcon_usb/driver_status.hpp"
#include "master/falcon_usb/plausibility.hpp"
#include "master/haptic_device.hpp"

namespace farhand::falcon_usb {

enum class Pacing : std::uint8_t {
  loop,    // a question per write(), and some in between if none comes
  device,  // a question as soon as the last one is answered
};

struct DriverConfig {
  FalconGeometry geometry;
  double counts_per_newton_meter = kGainCharacterised;
  double max_torque = 0.6;    // [N m] at the arm, the vector scaled as a whole
  double rise_time_s = 0.02;  // a torque may go from 0 to max_torque in this time
  std::uint8_t dead_man = kButtonCentre;
  std::uint8_t clutch = kButtonForward;
  Pacing pacing = Pacing::loop;
  ExchangeConfig exchange;
  PlausibilityConfig plausibility;
  ArmingConfig arming;
  UploadConfig upload;
  std::span<const std::byte> firmware;  // borrowed; empty: only a device that already runs
  Duration unanswered = std::chrono::milliseconds(10);  // zero torque after it
  Duration unwritten = std::chrono::milliseconds(20);   // likewise
  Duration stale = std::chrono::milliseconds(20);       // a sample this old is none
  Duration silent = std::chrono::milliseconds(80);      // given up after it
  Duration probe_time = std::chrono::milliseconds(250);
  Duration keep_alive = std::chrono::milliseconds(5);     // questions when nobody writes
  Duration unhome_time = std::chrono::milliseconds(100);  // without the homing bit, after a jump
  Duration close_time = std::chrono::milliseconds(50);    // for the last zero torques
};

class Driver {
 public:
  explicit Driver(const DriverConfig& config) noexcept;

  // The Talker of transport.hpp, and when next() wants to be called if nothing is heard.
  void hear(const Event& event, TimePoint now) noexcept;
  std::optional<Request> next(TimePoint now) noexcept;
  TimePoint due() const noexcept;

  // As HapticDevice has them. ok: homed or armed, with a sample that is not stale. The buttons are
  // the operator's once armed and let go: the gesture itself engages nothing.
  HandleReading read(TimePoint now) const noexcept;
  void write(TimePoint now, const Vec6& tau) noexcept;

  // From now on zero torque only; closed after three answers to it, or close_time.
  void close(TimePoint now) noexcept;
  // A request may still be on its way: nothing follows it.
  bool closed() const noexcept { return phase_ == Phase::closed; }

  DriverStatus status() const noexcept;
  // The last one that could be believed, once homed.
  const std::optional<Sample>& sample() const noexcept { return sample_; }
  // The last one, whatever it says; none without a device that answers.
  const std::optional<Sample>& newest() const noexcept { return newest_; }

 private:
  bool talking() const noexcept;
  bool knocks() const noexcept;
  void enter(Phase phase, TimePoint now) noexcept;
  void fail(Trouble trouble, TimePoint now) noexcept;
  void start(TimePoint now) noexcept;
  void begin_again(TimePoint now) noexcept;
  void give_up(TimePoint now) noexcept;
  void take(const Sample& sample, TimePoint now) noexcept;
  void judge(const Sample& sample, TimePoint now) noexcept;
  std::optional<Request> wish(TimePoint now) noexcept;
  std::optional<Request> probe(TimePoint now) noexcept;
  std::optional<Request> upload(TimePoint now) noexcept;
  Request ask(TimePoint now) noexcept;
  TimePoint time_up() const noexcept;
  TimePoint wish_at() const noexcept;
  TimePoint ask_at() const noexcept;
  Vec3 torque(TimePoint now) noexcept;

  DriverConfig config_;
  Exchange exchange_;
  Plausibility plausibility_;
  Arming arming_;
  FirmwareUpload upload_;
  std::span<const Control> set_up_;
  Phase phase_ = Phase::absent;
  Trouble trouble_ = Trouble::none;
  bool busy_ = false;        // a request is on its way
  bool uploaded_ = false;    // since it was plugged in or fell silent
  int failed_requests_ = 0;  // since the last answer
  TimePoint entered_{};      // the phase
  TimePoint heard_{};        // the last answer
  TimePoint asked_{};        // the last question
  TimePoint homing_from_{};  // the homing bit is set from then on
  std::uint8_t homed_ = 0;
  std::optional<Sample> sample_, newest_;
  Vec6 wanted_ = Vec6::Zero();
  TimePoint written_{};
  bool fresh_ = false;       // wanted_ has not left yet
  Vec6 tau_ = Vec6::Zero();  // sent last
  bool let_go_ = false;      // of all buttons, since armed
  bool closing_ = false;
  TimePoint close_by_{};
  TimePoint zero_from_ = TimePoint::max();  // the first question asked while closing
  int last_answers_ = 0;                    // to those
  std::uint64_t implausible_ = 0;
  std::uint64_t unplugged_ = 0;
};

static_assert(Talker<Driver>);

}  // namespace farhand::falcon_usb
