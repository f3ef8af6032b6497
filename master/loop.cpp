#include "master/loop.hpp"

#include <algorithm>
#include <array>

#include "common/secure_channel.hpp"

namespace farhand {

MasterLoop::MasterLoop(const MasterLoopConfig& config, Master& master, AnyDevice& device,
                       MasterLink* link, UdpSocket* socket, AhrsLine* ahrs,
                       Recorder<MasterRecord>& recorder) noexcept
    : config_(config),
      master_(master),
      device_(device),
      link_(link),
      socket_(socket),
      ahrs_(ahrs),
      recorder_(recorder) {
  if (link != nullptr && link->secure() != nullptr) prepare_dtls_thread();
}

void MasterLoop::run(Duration limit) noexcept {
  next_ = monotonic_now() + config_.period;
  const TimePoint last = next_ + limit;
  while (!stop_requested() && next_ < last && !taken_over()) turn();
  if (config_.park > Duration::zero()) park();

  // The slave holds, and the force fades by its slew limit.
  master_.stop();
  constexpr Duration kGoodbye = std::chrono::milliseconds(100);
  for (const TimePoint end = monotonic_now() + kGoodbye; monotonic_now() < end;) turn();
  write(device_, monotonic_now(), Vec6::Zero());
}

// As if the clutch were held, until the grip is there or the time is over.
void MasterLoop::park() noexcept {
  constexpr double kParked = 0.002;  // [m]
  const auto& position = master_.config().position_control;
  if (!position || !position->park_p_MH) return;
  if (record_ == nullptr || record_->tick.mode == Mode::fault) return;
  master_.park();
  double left = 0;
  const TimePoint end = monotonic_now() + config_.park;
  do {
    turn();
    left = (record_->tick.handle.X_MH.p - *position->park_p_MH).norm();
  } while (left > kParked && monotonic_now() < end);
}

void MasterLoop::turn() noexcept {
  record_ = &recorder_.slot();
  LoopTiming& timing = record_->timing;
  timing = {};
  const TimePoint begin = wake();
  timing.woken_late = begin - next_;

  HandleReading reading = read(device_, begin);
  if (ahrs_ != nullptr) reading.ahrs = ahrs_->next();
  const TimePoint sampled = monotonic_now();
  const MasterToSlave& message = master_.sample(begin, reading, slave(begin));
  const TimePoint sent = monotonic_now();
  send(message);
  const TimePoint waiting = monotonic_now();
  await_answer();
  const TimePoint acting = monotonic_now();
  record_->tick = master_.actuate(acting, slave(acting));
  const TimePoint decided = monotonic_now();
  write(device_, decided, record_->tick.tau);
  const TimePoint end = monotonic_now();

  timing.read = sampled - begin;
  timing.compute = (sent - sampled) + (decided - acting);
  timing.link = waiting - sent;
  timing.wait = acting - waiting;
  timing.answered = link_ != nullptr && answered();
  timing.write = end - decided;
  finish(end, end - begin - timing.wait);
}

// The wait for the answer finds its timer set; only a late turn has to set it anew.
TimePoint MasterLoop::wake() noexcept {
  cut_off_ = next_ + config_.cut_off;
  if (socket_ != nullptr) socket_->set_deadline(cut_off_);
  sleep_until(next_, config_.spin);
  const TimePoint begin = monotonic_now();
  if (begin - next_ <= config_.cut_off / 4) return begin;
  cut_off_ = begin + config_.cut_off;
  if (socket_ != nullptr) socket_->set_deadline(cut_off_);
  return begin;
}

// Overruns are judged against the next period's begin; periods that were missed altogether are left
// out, not made up.
void MasterLoop::finish(TimePoint end, Duration busy) noexcept {
  LoopTiming& timing = record_->timing;
  split_.busy(busy);
  next_ += config_.period;
  if (end > next_) {
    timing.overrun = true;
    // An answer awaited beyond the cut-off is the machine's doing too: the wait came back late.
    const Duration overslept = std::max(timing.wait - config_.cut_off, Duration(0));
    const auto shares = split_.split(end - next_, timing.woken_late + overslept);
    timing.overrun_own = shares.own;
    timing.overrun_machine = shares.machine;
    next_ += ((end - next_) / config_.period) * config_.period;
  }
  if (link_ != nullptr)
    record_->link =
        link_status(*link_, socket_->counters().send_would_block + socket_->counters().send_failed);
  recorder_.commit();
}

Peer<SlaveToMaster> MasterLoop::slave(TimePoint now) const noexcept {
  return link_ == nullptr ? Peer<SlaveToMaster>{} : peer<SlaveToMaster>(*link_, now, config_.lost);
}

void MasterLoop::send(const MasterToSlave& message) noexcept {
  if (link_ == nullptr) return;
  const TimePoint now = monotonic_now();
  socket_->send(link_->hello_due(now));
  const auto datagram = link_->encode(message, now);
  if (!datagram.empty()) sent_sequence_ = link_->sequence();
  socket_->send(datagram);
  send_handshake(link_->secure(), *socket_);
}

bool MasterLoop::taken_over() const noexcept {
  return link_ != nullptr && link_->taken_over();
}

bool MasterLoop::answered() const noexcept {
  return link_->newest() != nullptr && link_->newest()->echo_sequence >= sent_sequence_;
}

void MasterLoop::await_answer() noexcept {
  if (link_ == nullptr) return;
  const TimePoint spun = std::min(cut_off_, monotonic_now() + config_.spin);
  bool waits = !answered();  // or nothing was sent
  do {
    waits = waits && monotonic_now() < cut_off_ && wait_readable(spun);
    receive();
  } while (waits && !answered());
}

// Until the deadline that wake() set.
bool MasterLoop::wait_readable(TimePoint spun) noexcept {
  const bool spins = config_.spin > Duration::zero() && monotonic_now() < spun;
  return (spins && socket_->spin_readable(spun)) || socket_->wait_readable();
}

// Takes everything that waits up to the answer that is awaited, behind which nothing newer can be,
// but no more than a burst: the loop stays bounded under a flood.
void MasterLoop::receive() noexcept {
  constexpr int kBurst = 64;
  const bool awaiting = !answered();
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer;
  for (int i = 0; i < kBurst && !(awaiting && answered()); ++i) {
    const auto got = socket_->receive(buffer);
    if (!got) return;
    const auto datagram = std::span(buffer).first(got->size);
    if (link_->secure() != nullptr && link_->secure()->take(datagram, got->from)) continue;
    link_->receive(datagram, monotonic_now());
  }
}

}  // namespace farhand
