#include "master/falcon_usb/firmware_upload.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr std::array kGreeting{std::byte{0x0a}, std::byte{0x43}, std::byte{0x0d}};
constexpr std::array kGreetingAnswer{std::byte{0x0a}, std::byte{0x44}, std::byte{0x2c},
                                     std::byte{0x0d}};
constexpr std::array kHurry{std::byte{0x41}};

}  // namespace

const char* to_string(UploadFault fault) noexcept {
  switch (fault) {
    case UploadFault::none:
      return "none";
    case UploadFault::no_image:
      return "the firmware image is empty";
    case UploadFault::no_greeting:
      return "the boot loader does not answer";
    case UploadFault::no_fast_mode:
      return "the boot loader does not answer at the higher speed";
    case UploadFault::echo_missing:
      return "the boot loader stopped echoing";
    case UploadFault::echo_wrong:
      return "the boot loader echoed another byte than was sent";
  }
  return "unknown";
}

FirmwareUpload::FirmwareUpload(const UploadConfig& config, std::span<const std::byte> image,
                               TimePoint now) noexcept
    : config_(config), image_(image) {
  if (image.empty()) return;
  fault_ = UploadFault::none;
  begin(now);
}

void FirmwareUpload::begin(TimePoint now) noexcept {
  ++attempt_;
  attempt_end_ = now + config_.attempt_time;
  matched_ = sent_ = echoed_ = 0;
  set_up_ = kSetUpBoot;
  enter(Step::greet, now);
}

void FirmwareUpload::enter(Step step, TimePoint now) noexcept {
  step_ = step;
  asked_ = false;
  answer_due_ = now;
}

void FirmwareUpload::give_up(UploadFault fault, TimePoint now) noexcept {
  fault_ = fault;
  if (attempt_ < config_.attempts) return begin(now);
  step_ = Step::failed;
}

std::optional<Request> FirmwareUpload::next(TimePoint now) noexcept {
  if (succeeded() || failed()) return {};
  if (now >= attempt_end_) give_up(missing(), now);
  if (failed()) return {};
  if (const auto request = take_first(set_up_)) return request;
  switch (step_) {
    case Step::greet:
      return now >= answer_due_ ? ask(kGreeting, now) : std::nullopt;
    case Step::hurry:
      // Once only: the loader would take a second 'A' for the image's first byte.
      if (!asked_) return ask(kHurry, now);
      break;
    case Step::stream:
      if (echoed_ == sent_) return next_chunk(now);
      break;
    default:
      return {};
  }
  if (now < answer_due_) return {};
  give_up(missing(), now);
  return take_first(set_up_);
}

// What did not come in this step.
UploadFault FirmwareUpload::missing() const noexcept {
  if (step_ == Step::greet) return UploadFault::no_greeting;
  return step_ == Step::hurry ? UploadFault::no_fast_mode : UploadFault::echo_missing;
}

std::optional<Request> FirmwareUpload::ask(std::span<const std::byte> bytes,
                                           TimePoint now) noexcept {
  asked_ = true;
  answer_due_ = now + config_.answer_time;
  return request_of(bytes);
}

std::optional<Request> FirmwareUpload::next_chunk(TimePoint now) noexcept {
  const auto left = image_.subspan(sent_);
  const auto chunk = left.first(std::min(left.size(), kFtdiPayloadBytes));
  sent_ += chunk.size();
  return ask(chunk, now);
}

void FirmwareUpload::hear(std::span<const std::byte> bytes, TimePoint now) noexcept {
  const int attempt = attempt_;
  for (const std::byte b : bytes) {
    hear(b, now);
    if (attempt_ != attempt) return;  // the rest belongs to the attempt given up
  }
}

void FirmwareUpload::hear(std::byte b, TimePoint now) noexcept {
  switch (step_) {
    case Step::greet:
      // Some hosts see a zero before the answer.
      matched_ = b == kGreetingAnswer[matched_] ? matched_ + 1 : b == kGreetingAnswer[0] ? 1 : 0;
      if (matched_ < kGreetingAnswer.size()) return;
      set_up_ = kSetUpUpload;
      return enter(Step::hurry, now);
    case Step::hurry:
      // A loader may say something else first.
      if (asked_ && b == kHurry[0]) enter(Step::stream, now);
      return;
    case Step::stream:
      if (echoed_ == sent_ || b != image_[echoed_]) return give_up(UploadFault::echo_wrong, now);
      if (++echoed_ == image_.size()) step_ = Step::done;
      return;
    default:
      return;
  }
}

TimePoint FirmwareUpload::due() const noexcept {
  if (step_ == Step::done || step_ == Step::failed) return TimePoint::max();
  const bool free = !set_up_.empty() || !asked_ || (step_ == Step::stream && echoed_ == sent_);
  return free ? TimePoint::min() : std::min(answer_due_, attempt_end_);
}

double FirmwareUpload::progress() const noexcept {
  return image_.empty() ? 0 : static_cast<double>(echoed_) / static_cast<double>(image_.size());
}

}  // namespace farhand::falcon_usb
