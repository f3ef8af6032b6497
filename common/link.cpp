#include "common/link.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <type_traits>

#include "common/channel.hpp"
#include "common/secure_channel.hpp"

namespace farhand {
namespace {

// A drift of 100 ppm makes a hold of this length 10 us wrong; longer ones say little of the clock.
constexpr Duration kMaxHold = std::chrono::milliseconds(100);

template <typename Message>
constexpr bool kFromMaster = std::is_same_v<Message, MasterToSlave>;
template <typename Message>
constexpr Role kSender = kFromMaster<Message> ? Role::master : Role::slave;
template <typename Message>
constexpr PayloadType kType =
    kFromMaster<Message> ? PayloadType::master_to_slave : PayloadType::slave_to_master;

std::uint64_t stamp(Duration since_epoch) noexcept {
  return static_cast<std::uint64_t>(std::max(since_epoch, Duration::zero()).count());
}
Duration duration(std::uint64_t stamp) noexcept {
  return Duration(static_cast<Duration::rep>(stamp));
}

Exchange exchange(const Header& header, TimePoint now) noexcept {
  const Duration sent = duration(header.sent);
  return {.t1 = duration(header.echo_sent),
          .t2 = sent - duration(header.echo_hold),
          .t3 = sent,
          .t4 = now.time_since_epoch()};
}

}  // namespace

std::uint64_t LinkCounters::dropped() const noexcept {
  return std::accumulate(by_verdict.begin() + 1, by_verdict.end(), std::uint64_t{0});
}

template <typename Out, typename In>
Link<Out, In>::Link(const LinkConfig& config) : config_(config) {
  assert(config.session != 0 && config.hello_period > Duration::zero());
}

template <typename Out, typename In>
std::span<const std::byte> Link<Out, In>::encode(const Out& message, TimePoint now) noexcept {
  if (!peer_ || (kSender<Out> == Role::slave && now - heard_ > config_.silence)) return {};
  Header header{.session = config_.session,
                .peer_session = peer_->session,
                .sequence = sequence_ + 1,
                .sent = stamp(now.time_since_epoch())};
  if (newest_) {
    header.echo_sequence = newest_->sequence;
    header.echo_sent = stamp(newest_->sent);
    header.echo_hold = stamp(now - newest_->received);
  }
  std::array<std::byte, kMaxPayloadBytes> payload;
  const std::size_t size = codec_.encode(header, message, payload);
  if (size == 0) ++counters_.refused_to_send;
  if (size > 0) ++sequence_;
  return sealed(std::span(payload).first(size), data_);
}

template <typename Out, typename In>
std::span<const std::byte> Link<Out, In>::sealed(std::span<const std::byte> payload,
                                                 Datagram& to) noexcept {
  return std::span(to).first(config_.secure ? config_.secure->seal(payload, to)
                                            : seal(payload, to));
}

template <typename Out, typename In>
std::span<const std::byte> Link<Out, In>::hello_due(TimePoint now) noexcept {
  const bool heard = newest_ && now - newest_->received <= config_.silence;
  if (heard || taken_over() || (next_hello_ && now < *next_hello_)) return {};
  next_hello_ = now + config_.hello_period;
  std::array<std::byte, kMaxPayloadBytes> payload;
  return sealed(std::span(payload).first(codec_.encode(hello(), payload)), hello_);
}

// Once it led, a master does not fight for its place.
template <typename Out, typename In>
Hello Link<Out, In>::hello() const noexcept {
  Hello h{.role = kSender<Out>,
          .session = config_.session,
          .scene_hash = config_.scene_hash,
          .peer_session = peer_ ? peer_->session : 0};
  if (h.role == Role::master) {
    h.take_over = config_.take_over && leased_by_ == 0;
  } else {
    h.lease = peer_ ? Lease::held : Lease::none;
    h.leases = leases_;
  }
  return h;
}

template <typename Out, typename In>
void Link<Out, In>::tell(std::uint64_t session, Lease lease) noexcept {
  Hello h = hello();
  h.peer_session = session;
  h.lease = lease;
  std::array<std::byte, kMaxPayloadBytes> payload;
  const auto bytes = std::span(payload).first(codec_.encode(h, payload));
  answer_size_ =
      config_.secure ? config_.secure->seal_answer(bytes, answer_) : seal(bytes, answer_);
}

// Its data comes every tick; once a hello's period will do.
template <typename Out, typename In>
void Link<Out, In>::tell_former(std::uint64_t session, TimePoint now) noexcept {
  if (told_former_ && now - *told_former_ < config_.hello_period) return;
  told_former_ = now;
  tell(session, Lease::lost);
}

template <typename Out, typename In>
Verdict Link<Out, In>::receive(std::span<const std::byte> datagram, TimePoint now) noexcept {
  ++counters_.received;
  answer_size_ = 0;
  const Verdict verdict = judge(datagram, now);
  if (verdict == Verdict::accepted || verdict == Verdict::too_late) heard_ = now;
  if (verdict == Verdict::accepted && config_.secure) config_.secure->settle();
  ++counters_.by_verdict[static_cast<std::size_t>(verdict)];
  return verdict;
}

template <typename Out, typename In>
Verdict Link<Out, In>::judge(std::span<const std::byte> datagram, TimePoint now) noexcept {
  const Opened opened =
      config_.secure ? config_.secure->open(datagram, payload_) : open(datagram, payload_);
  if (opened.verdict != Verdict::accepted) return opened.verdict;
  const std::span<const std::byte> payload = std::span(payload_).first(opened.size);
  switch (static_cast<PayloadType>(payload[0])) {
    case PayloadType::hello:
      return on_hello(payload, now);
    case kType<In>:
      return on_data(payload, now);
    case kType<Out>:
      return Verdict::wrong_role;
  }
  return Verdict::unexpected_type;
}

template <typename Out, typename In>
Verdict Link<Out, In>::on_hello(std::span<const std::byte> payload, TimePoint now) noexcept {
  Hello hello;
  const Verdict verdict = codec_.decode(payload, hello);
  if (verdict == Verdict::wrong_version)
    refusal_ = {PeerRefusal::Reason::version, hello.protocol_version, 0};
  if (verdict != Verdict::accepted) return verdict;
  if (hello.role != kSender<In>) return Verdict::wrong_role;
  if (hello.scene_hash != config_.scene_hash) {
    refusal_ = {PeerRefusal::Reason::scene, hello.protocol_version, hello.scene_hash};
    return Verdict::wrong_scene;
  }
  const Verdict lease = kFromMaster<In> ? lease_to(hello, now) : lease_from(hello, now);
  if (lease != Verdict::accepted) return lease;
  if (!peer_ || peer_->session != hello.session) adopt(hello);
  refusal_ = {};
  return Verdict::accepted;
}

// As the slave.
template <typename Out, typename In>
Verdict Link<Out, In>::lease_to(const Hello& master, TimePoint now) noexcept {
  if (retired(master.session)) {
    tell(master.session, Lease::lost);
    return Verdict::foreign_session;
  }
  if (peer_ && peer_->session == master.session) return Verdict::accepted;
  if (peer_ && now - heard_ <= config_.silence && !master.take_over) {
    tell(master.session, Lease::refused);
    return Verdict::leased;
  }
  ++leases_;
  return Verdict::accepted;
}

// As the master. What was under way for long, or was meant for another, changes nothing.
template <typename Out, typename In>
Verdict Link<Out, In>::lease_from(const Hello& slave, TimePoint now) noexcept {
  if (taken_over()) return Verdict::leased;
  if (retired(slave.session)) return Verdict::foreign_session;
  if (slave.peer_session != 0 && slave.peer_session != config_.session)
    return Verdict::other_recipient;
  if (slave.session == leased_by_ && slave.leases < leases_) return Verdict::older;
  if (slave.lease == Lease::refused || slave.lease == Lease::lost) {
    if (!refused_since_) refused_since_ = now;
    if (now - *refused_since_ > config_.silence) refusal_ = {PeerRefusal::Reason::led};
    if (slave.lease == Lease::lost) refusal_ = {PeerRefusal::Reason::taken_over};
    peer_.reset();
    newest_.reset();
    return Verdict::leased;
  }
  refused_since_.reset();
  if (slave.lease == Lease::held) {
    leased_by_ = slave.session;
    leases_ = slave.leases;
  }
  return Verdict::accepted;
}

template <typename Out, typename In>
void Link<Out, In>::adopt(const Hello& hello) noexcept {
  if (peer_) retired_[retirements_++ % retired_.size()] = peer_->session;
  peer_ = hello;
  newest_.reset();
  window_ = {};
  clock_.clear();
  late_since_.reset();
  next_hello_.reset();  // it waits for ours
  lost_before_ = quality_.lost;
  quality_.round_trip_known = false;
  quality_.round_trip = quality_.jitter = {};
}

template <typename Out, typename In>
bool Link<Out, In>::retired(std::uint64_t session) const noexcept {
  return std::find(retired_.begin(), retired_.end(), session) != retired_.end();
}

template <typename Out, typename In>
Verdict Link<Out, In>::on_data(std::span<const std::byte> payload, TimePoint now) noexcept {
  Header header;
  const Verdict verdict = codec_.decode(payload, header, incoming_);
  if (verdict != Verdict::accepted) return verdict;
  if (!peer_ || header.session != peer_->session) {
    if (kFromMaster<In> && retired(header.session)) tell_former(header.session, now);
    return Verdict::foreign_session;
  }
  if (header.peer_session != config_.session) return Verdict::other_recipient;
  if (header.echo_sequence > sequence_ || header.echo_sent > stamp(now.time_since_epoch()))
    return Verdict::bad_echo;

  if (header.sequence > window_.highest() && too_late(header, now)) return Verdict::too_late;
  const SequenceWindow::Place place = window_.admit(header.sequence);
  quality_.lost = lost_before_ + window_.skipped();
  if (place == SequenceWindow::Place::duplicate) return Verdict::duplicate;
  if (place == SequenceWindow::Place::late) ++quality_.reordered;
  if (place != SequenceWindow::Place::newest) return Verdict::older;
  accept(header, now);
  return Verdict::accepted;
}

// The clock does not learn from what is too late: a side that slept for longer than the window
// would take the oldest that waited for the fastest there is.
template <typename Out, typename In>
bool Link<Out, In>::too_late(const Header& header, TimePoint now) noexcept {
  if (header.echo_sequence == 0 || clock_.lateness(exchange(header, now)) <= config_.max_late) {
    late_since_.reset();
    return false;
  }
  if (!late_since_ || now - late_at_ > config_.silence) late_since_ = now;
  late_at_ = now;
  if (now - *late_since_ < ClockSync::kWindow) return true;
  clock_.clear();
  late_since_.reset();
  return false;
}

template <typename Out, typename In>
void Link<Out, In>::accept(const Header& header, TimePoint now) noexcept {
  measure(header, now);
  const Duration sent = duration(header.sent);
  const ClockEstimate clock = clock_.estimate();
  const Duration transit = now.time_since_epoch() - sent + clock.offset;
  newest_ = {.message = incoming_,
             .sequence = header.sequence,
             .echo_sequence = header.echo_sequence,
             .echo_sent = duration(header.echo_sent),
             .received = now,
             .sent = sent,
             .transit = clock.valid ? std::max(transit, Duration::zero()) : Duration::zero(),
             .transit_known = clock.valid};
}

template <typename Out, typename In>
void Link<Out, In>::measure(const Header& header, TimePoint now) noexcept {
  const Duration sent = duration(header.sent);
  if (newest_) {
    const Duration change = (now - newest_->received) - (sent - newest_->sent);
    quality_.jitter += (std::chrono::abs(change) - quality_.jitter) / 16;
  }
  if (header.echo_sequence == 0) return;
  const Exchange x = exchange(header, now);
  quality_.round_trip_known = true;
  quality_.round_trip = std::max(x.t4 - x.t1 - (x.t3 - x.t2), Duration::zero());
  if (x.t3 - x.t2 <= kMaxHold) clock_.add(x);
}

template class Link<MasterToSlave, SlaveToMaster>;
template class Link<SlaveToMaster, MasterToSlave>;

}  // namespace farhand
