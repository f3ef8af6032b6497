#include "slave/loop.hpp"

#include <array>

#include "common/secure_channel.hpp"

namespace farhand {

SlaveLoop::SlaveLoop(const SlaveLoopConfig& config, Slave& slave, AnyRobot& robot, SlaveLink& link,
                     UdpSocket& socket, Recorder<SlaveRecord>& recorder) noexcept
    : config_(config),
      slave_(slave),
      robot_(robot),
      link_(link),
      socket_(socket),
      recorder_(recorder),
      phase_(config.period, monotonic_now() + config.period) {
  if (link.secure() != nullptr) prepare_dtls_thread();
}

void SlaveLoop::run(Duration limit) noexcept {
  const TimePoint last = phase_.deadline() + limit;
  while (!stop_requested() && phase_.deadline() < last) turn();

  slave_.stop();
  constexpr Duration kGoodbye = std::chrono::milliseconds(200);
  for (const TimePoint end = monotonic_now() + kGoodbye; monotonic_now() < end;) turn();
}

void SlaveLoop::turn() noexcept {
  record_ = &recorder_.slot();
  LoopTiming& timing = record_->timing;
  timing = {};
  const auto arrival = await_message();
  const TimePoint planned = phase_.deadline();
  const TimePoint begin = monotonic_now();

  const RobotReading reading = read(robot_, begin);
  const TimePoint sampled = monotonic_now();
  record_->tick = slave_.tick(begin, master(begin), reading);
  const TimePoint decided = monotonic_now();
  write(robot_, decided, record_->tick.tau);
  const TimePoint written = monotonic_now();
  send();
  const TimePoint end = monotonic_now();

  timing.read = sampled - begin;
  timing.compute = decided - sampled;
  timing.write = written - decided;
  timing.link = end - written;
  phase_.ticked(end, arrival);
  finish(planned, begin, end);
}

// Late is a tick that began after the last instant at which it should have, or ended when the next
// should have begun.
void SlaveLoop::finish(TimePoint planned, TimePoint begin, TimePoint end) noexcept {
  LoopTiming& timing = record_->timing;
  timing.woken_late = std::max(begin - planned, Duration(0));
  split_.busy(end - begin);
  const TimePoint due = planned + config_.period / 2;
  if (end > due) {
    timing.overrun = true;
    const auto shares = split_.split(end - due, timing.woken_late);
    timing.overrun_own = shares.own;
    timing.overrun_machine = shares.machine;
  }
  record_->link =
      link_status(link_, socket_.counters().send_would_block + socket_.counters().send_failed);
  recorder_.commit();
}

Peer<MasterToSlave> SlaveLoop::master(TimePoint now) const noexcept {
  return peer<MasterToSlave>(link_, now, config_.lost);
}

std::optional<TimePoint> SlaveLoop::await_message() noexcept {
  const auto unused = [this]() -> std::optional<TimePoint> {
    const auto* newest = link_.newest();
    if (newest == nullptr || newest->sequence == ticked_sequence_) return {};
    return newest->received;
  };
  sleep_until(phase_.earliest());
  socket_.set_deadline(phase_.deadline());  // before the message can be there
  receive();
  for (TimePoint due = phase_.due(unused()); monotonic_now() < due && wait_readable(due);
       due = phase_.due(unused()))
    receive();
  const auto arrival = unused();
  if (arrival) ticked_sequence_ = link_.newest()->sequence;
  return arrival;
}

// At most until the deadline that was set ahead.
bool SlaveLoop::wait_readable(TimePoint until) noexcept {
  if (config_.spin > Duration::zero()) {
    const TimePoint begin = std::min(until, phase_.expected() - config_.spin);
    const TimePoint end = std::min(until, phase_.expected() + config_.spin);
    if (monotonic_now() < begin && socket_.wait_readable(begin)) return true;
    if (monotonic_now() < end && socket_.spin_readable(end)) return true;
  }
  return socket_.wait_readable();
}

// Takes everything that waits up to a message younger than a period, behind which nothing newer can
// be, but no more than a burst: the loop stays bounded under a flood. Only an accepted datagram may
// say where the master is.
void SlaveLoop::receive() noexcept {
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer;
  for (int i = 0; i < kBurst; ++i) {
    const auto got = socket_.receive(buffer);
    if (!got) return;
    const auto datagram = std::span(buffer).first(got->size);
    if (link_.secure() != nullptr && link_.secure()->take(datagram, got->from)) continue;
    const TimePoint now = monotonic_now();
    const bool accepted = link_.receive(datagram, now) == Verdict::accepted;
    if (accepted) socket_.set_peer(got->from);
    if (!link_.answer().empty()) socket_.send_to(link_.answer(), got->from);
    if (accepted && newest_for_sure(now)) return;
  }
}

bool SlaveLoop::newest_for_sure(TimePoint now) const noexcept {
  const auto* newest = link_.newest();
  return newest != nullptr && newest->transit_known && newest->age(now) < config_.period;
}

void SlaveLoop::send() noexcept {
  const TimePoint now = monotonic_now();
  socket_.send(link_.hello_due(now));
  if (record_->tick.answers) socket_.send(link_.encode(record_->tick.out, now));
  send_handshake(link_.secure(), socket_);  // last: strangers make it long
}

}  // namespace farhand
