#include "master/falcon_usb/driver.hpp"

#include <algorithm>

namespace farhand::falcon_usb {
namespace {

constexpr int kMostFailedRequests = 3;  // in a row
constexpr int kLastAnswers = 3;

std::uint8_t leds(Phase phase) noexcept {
  return phase == Phase::armed ? kLedGreen : phase == Phase::homed ? kLedBlue : kLedRed;
}

}  // namespace

Driver::Driver(const DriverConfig& config) noexcept
    : config_(config),
      exchange_(config.exchange),
      plausibility_(config.plausibility, config.geometry),
      arming_(config.arming) {}

bool Driver::talking() const noexcept {
  return phase_ == Phase::homing || phase_ == Phase::homed || phase_ == Phase::armed;
}

void Driver::enter(Phase phase, TimePoint now) noexcept {
  phase_ = phase;
  entered_ = now;
  let_go_ = false;
  if (phase == Phase::armed) return;
  tau_.setZero();
  arming_.forget();
  plausibility_.forget();
  if (phase != Phase::homed) sample_.reset();
  if (!talking()) newest_.reset();
}

void Driver::fail(Trouble trouble, TimePoint now) noexcept {
  trouble_ = trouble;
  enter(Phase::failed, now);
}

void Driver::start(TimePoint now) noexcept {
  exchange_.restart();
  set_up_ = kSetUpPackets;
  homed_ = 0;
  enter(Phase::setting_up, now);
}

void Driver::hear(const Event& event, TimePoint now) noexcept {
  if (phase_ == Phase::closed) return;
  switch (event.kind) {
    case EventKind::attached:
      busy_ = uploaded_ = false;
      failed_requests_ = 0;
      return start(now);
    case EventKind::refused:
      return fail(trouble_of(event.refusal), now);
    case EventKind::sent:
      busy_ = false;
      return;
    case EventKind::failed:
      busy_ = false;
      return begin_again(now);
    case EventKind::detached:
      busy_ = false;
      ++unplugged_;
      trouble_ = Trouble::unplugged;
      return enter(Phase::absent, now);
    case EventKind::received:
      if (phase_ == Phase::uploading) return upload_.hear(payload(event.packet), now);
      if (phase_ != Phase::probing && !talking() && !knocks()) return;
      if (const Sample* sample = exchange_.hear(payload(event.packet), now)) take(*sample, now);
      return;
  }
}

// After a request that failed. While closing the zero torque must get through: it is said again as
// an unanswered question is.
void Driver::begin_again(TimePoint now) noexcept {
  if (closing_ && (talking() || phase_ == Phase::probing)) return;
  if (++failed_requests_ > kMostFailedRequests) return fail(Trouble::request_failed, now);
  start(now);
}

void Driver::take(const Sample& sample, TimePoint now) noexcept {
  heard_ = now;
  newest_ = sample;
  homed_ = sample.answer.homed;
  failed_requests_ = 0;
  const bool to_zero = sample.at - sample.age >= zero_from_;
  if (to_zero && ++last_answers_ >= kLastAnswers) return enter(Phase::closed, now);
  if (phase_ == Phase::probing || knocks()) {
    trouble_ = Trouble::none;
    enter(Phase::homing, now);
  }
  const bool homed = homed_ == kAllHomed && asked_ >= homing_from_;
  if (homed && phase_ == Phase::homing) enter(Phase::homed, now);
  if (!homed && phase_ != Phase::homing) enter(Phase::homing, now);
  if (homed) judge(sample, now);
}

void Driver::judge(const Sample& sample, TimePoint now) noexcept {
  const Verdict verdict = plausibility_.judge(sample);
  if (verdict == Verdict::first) return;
  if (verdict == Verdict::plausible) {
    trouble_ = Trouble::none;
    sample_ = sample;
    let_go_ = let_go_ || (phase_ == Phase::armed && sample.answer.buttons == 0);
    if (phase_ == Phase::homed && arming_.step(sample.answer.buttons, now))
      enter(Phase::armed, now);
    return;
  }
  ++implausible_;
  if (!plausibility_.jumped()) return;
  trouble_ = Trouble::jumped;
  homing_from_ = now + config_.unhome_time;
  enter(Phase::homing, now);
}

std::optional<Request> Driver::next(TimePoint now) noexcept {
  if (now >= time_up()) give_up(now);
  if (busy_) return {};
  const auto request = wish(now);
  busy_ = request.has_value();
  return request;
}

// When patience ends, whether or not a request is on its way.
TimePoint Driver::time_up() const noexcept {
  if (phase_ == Phase::closed) return TimePoint::max();
  const bool may_drive = talking() || phase_ == Phase::setting_up || phase_ == Phase::probing;
  if (closing_ && !may_drive) return TimePoint::min();
  const TimePoint closed = closing_ ? close_by_ : TimePoint::max();
  return talking() ? std::min(closed, heard_ + config_.silent) : closed;
}

void Driver::give_up(TimePoint now) noexcept {
  if (closing_ && (!talking() || now >= close_by_)) return enter(Phase::closed, now);
  trouble_ = Trouble::silent;
  uploaded_ = false;
  start(now);
}

std::optional<Request> Driver::wish(TimePoint now) noexcept {
  if (phase_ == Phase::setting_up) {
    if (const auto request = take_first(set_up_)) return request;
    enter(Phase::probing, now);
  }
  if (phase_ == Phase::probing) return probe(now);
  if (phase_ == Phase::uploading) return upload(now);
  return (talking() || knocks()) && now >= ask_at() ? std::optional(ask(now)) : std::nullopt;
}

std::optional<Request> Driver::probe(TimePoint now) noexcept {
  if (now < entered_ + config_.probe_time)
    return exchange_.free(now) ? std::optional(ask(now)) : std::nullopt;
  if (closing_) {
    enter(Phase::closed, now);
    return {};
  }
  if (uploaded_ || config_.firmware.empty()) {
    fail(uploaded_ ? Trouble::not_running : Trouble::no_firmware, now);
    return {};
  }
  upload_ = FirmwareUpload(config_.upload, config_.firmware, now);
  enter(Phase::uploading, now);
  return upload(now);
}

std::optional<Request> Driver::upload(TimePoint now) noexcept {
  const auto request = upload_.next(now);
  if (upload_.failed()) fail(Trouble::upload_failed, now);
  if (!upload_.succeeded()) return request;
  uploaded_ = true;
  start(now);
  return take_first(set_up_);
}

// One that was silent for a while, for want of power or of a machine with time for it, is taken up
// again when it answers.
bool Driver::knocks() const noexcept {
  return phase_ == Phase::failed && trouble_ == Trouble::no_firmware && !closing_;
}

TimePoint Driver::ask_at() const noexcept {
  if (knocks()) return asked_ + config_.probe_time;
  const TimePoint free = exchange_.free_at();
  const bool waits = config_.pacing == Pacing::loop && !fresh_;
  return waits ? std::max(free, asked_ + config_.keep_alive) : free;
}

Request Driver::ask(TimePoint now) noexcept {
  Command command{.homing = now >= homing_from_, .leds = closing_ ? std::uint8_t{0} : leds(phase_)};
  if (phase_ == Phase::armed)
    command.motors = motor_counts(torque(now), config_.counts_per_newton_meter);
  if (closing_) zero_from_ = std::min(zero_from_, now);
  exchange_.asked(now);
  asked_ = now;
  fresh_ = false;
  return request_of(encode(command));
}

Vec3 Driver::torque(TimePoint now) noexcept {
  const bool lost =
      now - heard_ >= config_.unanswered || now - written_ >= config_.unwritten || closing_;
  const double share = std::min(1.0, seconds(now - asked_) / config_.rise_time_s);
  LimitSet limits = kLimitNone;
  tau_ = lost ? Vec6(Vec6::Zero())
              : limit_motor_torques(config_.max_torque, share * config_.max_torque, wanted_, tau_,
                                    limits);
  return tau_.head<3>();
}

TimePoint Driver::due() const noexcept {
  return busy_ ? time_up() : std::min(time_up(), wish_at());
}

TimePoint Driver::wish_at() const noexcept {
  switch (phase_) {
    case Phase::setting_up:
      return TimePoint::min();
    case Phase::probing:
      return std::min(exchange_.free_at(), entered_ + config_.probe_time);
    case Phase::uploading:
      return upload_.due();
    case Phase::homing:
    case Phase::homed:
    case Phase::armed:
      return ask_at();
    default:
      return knocks() ? ask_at() : TimePoint::max();
  }
}

HandleReading Driver::read(TimePoint now) const noexcept {
  HandleReading out;
  if (!sample_ || now - sample_->at + sample_->age > config_.stale) return out;
  const Answer& answer = sample_->answer;
  const Eigen::Vector3i counts(answer.encoders[0], answer.encoders[1], answer.encoders[2]);
  out.ok = true;
  out.theta.head<3>() = theta1_from_counts(config_.geometry, counts);
  if (!let_go_) return out;
  out.dead_man = (answer.buttons & config_.dead_man) != 0;
  out.clutch = (answer.buttons & config_.clutch) != 0;
  return out;
}

void Driver::write(TimePoint now, const Vec6& tau) noexcept {
  wanted_ = tau;
  written_ = now;
  fresh_ = true;
}

void Driver::close(TimePoint now) noexcept {
  if (closing_) return;
  closing_ = true;
  close_by_ = now + config_.close_time;
  // The motors may hold a torque that was sent before the requests failed.
  if (phase_ == Phase::failed && trouble_ == Trouble::request_failed) start(now);
}

DriverStatus Driver::status() const noexcept {
  return {.phase = phase_,
          .trouble = trouble_,
          .homed = homed_,
          .upload_fault = upload_.fault(),
          .upload_attempt = upload_.attempt(),
          .upload_progress = upload_.progress(),
          .exchange = exchange_.counters(),
          .skipped_bytes = exchange_.skipped_bytes(),
          .implausible = implausible_,
          .unplugged = unplugged_};
}

}  // namespace farhand::falcon_usb
