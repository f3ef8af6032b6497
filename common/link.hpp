// One end of the connection: sessions, newest-wins, counters and clocks. No socket and no clock of
// its own: the shell passes datagrams and times in and sends what comes out. The same two ends
// therefore run over UDP, or back to back in one process in virtual time.
//
// Handshake: each side says hello until it has its peer's hello and data that answers its own
// session. A hello with a new session takes the place of the old peer, whose datagrams are dropped
// from then on, so either side may restart at any time. Data flows as soon as the peer is known.
//
// Of several masters one leads: it has the slave's lease for as long as the slave hears it, and
// `silence` longer. Who says hello meanwhile is refused and told, and gets in by a later hello, or
// at once if it asks to take over. Then the one that led is told; its session never leads again.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/clock_sync.hpp"
#include "common/codec.hpp"
#include "common/sequence_window.hpp"
#include "common/time.hpp"
#include "common/wire.hpp"

namespace farhand {

class SecureChannel;

struct LinkConfig {
  std::uint64_t session = 0;  // random, not 0, another one at every start
  std::uint64_t scene_hash = 0;
  Duration hello_period = std::chrono::milliseconds(100);
  // Without data for so long: hello again. Without anything: the master's lease is over.
  Duration silence = std::chrono::milliseconds(500);
  bool take_over = false;  // a master's: lead in the place of another, once
  // What took so much longer than the fastest of the clock's window is not taken: a side that wakes
  // up does not act on what waited meanwhile. Only once the clock is known. If nothing else comes
  // for as long as the window, the network got slower for good: the clock begins anew.
  Duration max_late = std::chrono::milliseconds(100);
  SecureChannel* secure = nullptr;  // borrowed; nullptr: the plain channel
};

// received == accepted() + dropped(), always.
struct LinkCounters {
  std::uint64_t received = 0;
  std::array<std::uint64_t, kVerdicts> by_verdict{};
  std::uint64_t refused_to_send = 0;  // own messages that were not valid

  std::uint64_t operator[](Verdict v) const noexcept {
    return by_verdict[static_cast<std::size_t>(v)];
  }
  std::uint64_t accepted() const noexcept { return (*this)[Verdict::accepted]; }
  std::uint64_t dropped() const noexcept;
};

// How the network treats the peer's data. Counts run on over the peer's restarts.
struct LinkQuality {
  bool round_trip_known = false;
  Duration round_trip{};   // of the last exchange, the peer's hold taken off
  Duration jitter{};       // mean change of the transit time between datagrams (RFC 3550, 6.4.1)
  std::uint64_t lost = 0;  // skipped in the sequence and not come since
  std::uint64_t reordered = 0;  // came after a newer one
};

// Why a peer's hello was refused, for the user; cleared by a hello that is not.
struct PeerRefusal {
  enum class Reason : std::uint8_t {
    none,
    version,
    scene,
    led,        // another master leads the slave, for longer than a crashed one would
    taken_over  // for good: another master took over
  } reason = Reason::none;
  std::uint32_t peer_version = 0;
  std::uint64_t peer_scene_hash = 0;  // known only if the version matches
};

template <typename In>
struct Received {
  In message;
  std::uint64_t sequence = 0;
  std::uint64_t echo_sequence = 0;  // our newest that the peer had when it sent this; 0: none
  Duration echo_sent{};             // when that was sent, on our clock since its epoch
  TimePoint received{};             // our clock
  Duration sent{};                  // the peer's clock, since its epoch
  Duration transit{};               // estimate of the way here, as of its arrival; 0 while unknown
  bool transit_known = false;

  Duration age(TimePoint now) const noexcept { return now - received + transit; }
};

// Times passed in are not before their clock's epoch and never decrease.
template <typename Out, typename In>
class Link {
 public:
  explicit Link(const LinkConfig& config);

  // The next data datagram, valid until the next call of encode. Empty before the peer's hello, for
  // a message that is not valid (counted), and from a slave to a master that it has not heard for
  // config.silence: no stream runs on to where nobody may be.
  std::span<const std::byte> encode(const Out& message, TimePoint now) noexcept;

  // A hello if one is due now, which makes the next one due a period later; otherwise empty. Valid
  // until the next call of hello_due.
  std::span<const std::byte> hello_due(TimePoint now) noexcept;

  // Only `accepted` changes what the link knows of its peer; but a refused hello is remembered
  // (peer_refusal), `too_late` is still a sign of life, and `leased` tells a master that it leads
  // no more.
  Verdict receive(std::span<const std::byte> datagram, TimePoint now) noexcept;

  // A slave's word to the sender of the last datagram received, who has not the lease; to be sent
  // there at once. Never longer than what it answers. Empty: nothing.
  std::span<const std::byte> answer() const noexcept {
    return std::span(answer_).first(answer_size_);
  }

  // Another master took over from this one: nothing leaves any more.
  bool taken_over() const noexcept { return refusal_.reason == PeerRefusal::Reason::taken_over; }

  // The newest message of the present peer; nullptr before the first.
  const Received<In>* newest() const noexcept { return newest_ ? &*newest_ : nullptr; }
  // The newest one arrived at most `limit` ago.
  bool fresh(TimePoint now, Duration limit) const noexcept {
    return newest_ && now - newest_->received <= limit;
  }
  // Hellos are exchanged and the peer's data has answered our session. Silence does not end it.
  bool connected() const noexcept { return newest_.has_value(); }

  // Seals and opens this link's datagrams; nullptr: the plain channel does.
  SecureChannel* secure() const noexcept { return config_.secure; }

  // Of the last datagram encoded.
  std::uint64_t sequence() const noexcept { return sequence_; }

  const std::optional<Hello>& peer() const noexcept { return peer_; }
  const PeerRefusal& peer_refusal() const noexcept { return refusal_; }
  const LinkCounters& counters() const noexcept { return counters_; }
  const LinkQuality& quality() const noexcept { return quality_; }
  ClockEstimate clock() const noexcept { return clock_.estimate(); }

 private:
  using Datagram = std::array<std::byte, kMaxDatagramBytes>;

  std::span<const std::byte> sealed(std::span<const std::byte> payload, Datagram& to) noexcept;
  Verdict judge(std::span<const std::byte> datagram, TimePoint now) noexcept;
  Verdict on_hello(std::span<const std::byte> payload, TimePoint now) noexcept;
  Verdict lease_to(const Hello& master, TimePoint now) noexcept;
  Verdict lease_from(const Hello& slave, TimePoint now) noexcept;
  Hello hello() const noexcept;
  void tell(std::uint64_t session, Lease lease) noexcept;
  void tell_former(std::uint64_t session, TimePoint now) noexcept;
  Verdict on_data(std::span<const std::byte> payload, TimePoint now) noexcept;
  void adopt(const Hello& hello) noexcept;
  bool retired(std::uint64_t session) const noexcept;
  bool too_late(const Header& header, TimePoint now) noexcept;
  void accept(const Header& header, TimePoint now) noexcept;
  void measure(const Header& header, TimePoint now) noexcept;

  LinkConfig config_;
  Codec codec_;
  std::array<std::byte, kMaxPayloadBytes> payload_{};
  Datagram data_{}, hello_{}, answer_{};
  std::size_t answer_size_ = 0;
  std::uint64_t sequence_ = 0;
  std::optional<TimePoint> next_hello_;  // nothing: at once

  std::optional<Hello> peer_;
  TimePoint heard_{};            // when something of it came last that was not of the past
  std::uint32_t leases_ = 0;     // given; a master's: the number of the one it has or had
  std::uint64_t leased_by_ = 0;  // a master's: the slave of that one
  std::optional<TimePoint> refused_since_, told_former_;
  std::array<std::uint64_t, 8> retired_{};  // the peer's former sessions, the last ones
  std::size_t retirements_ = 0;
  SequenceWindow window_;
  ClockSync clock_;
  TimePoint late_at_{};                  // the last of them
  std::optional<TimePoint> late_since_;  // since then, all that is new came too late
  std::optional<Received<In>> newest_;
  In incoming_;

  std::uint64_t lost_before_ = 0;  // by former sessions
  LinkCounters counters_;
  LinkQuality quality_;
  PeerRefusal refusal_;
};

using MasterLink = Link<MasterToSlave, SlaveToMaster>;
using SlaveLink = Link<SlaveToMaster, MasterToSlave>;

extern template class Link<MasterToSlave, SlaveToMaster>;
extern template class Link<SlaveToMaster, MasterToSlave>;

}  // namespace farhand
