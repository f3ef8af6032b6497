#include "common/secure_channel.hpp"

#include <algorithm>

namespace farhand {

SecureChannel::SecureChannel(const SecureChannelConfig& config, const Credentials& credentials)
    : config_(config),
      handshake_(config.server ? DtlsRole::client : DtlsRole::server, credentials, config.dtls) {}

SecureChannel::~SecureChannel() {
  delete made_.load();
  delete retired_.load();
}

// The other half publishes the next one only after made_ is empty again, so retired_ is free here.
void SecureChannel::adopt() noexcept {
  DtlsSession* made = made_.load(std::memory_order_acquire);
  if (made == nullptr) return;
  auto& place = config_.server ? session_ : beside_;
  retired_.store(place.release(), std::memory_order_relaxed);
  place.reset(made);
  beside_open_ = place == beside_;
  came_beside_ = false;
  made_.store(nullptr, std::memory_order_release);
}

std::size_t SecureChannel::seal(std::span<const std::byte> payload,
                                std::span<std::byte> datagram) noexcept {
  adopt();
  return session_ ? session_->seal(payload, datagram) : 0;
}

Opened SecureChannel::open(std::span<const std::byte> datagram,
                           std::span<std::byte> payload) noexcept {
  adopt();
  const Verdict verdict = judge_record(datagram);
  if (verdict != Verdict::accepted) return {verdict};
  if (!session_ && !beside_open_) return {Verdict::not_connected};
  Opened opened{Verdict::not_authentic};
  if (session_) opened = session_->open(datagram, payload);
  came_beside_ = opened.verdict != Verdict::accepted && beside_open_;
  if (came_beside_) opened = beside_->open(datagram, payload);
  if (opened.verdict == Verdict::accepted) opened_.fetch_add(1, std::memory_order_relaxed);
  return opened;
}

// What was in use waits, closed, in the other's place for the next to be adopted.
void SecureChannel::settle() noexcept {
  if (!came_beside_) return;
  std::swap(session_, beside_);
  beside_open_ = came_beside_ = false;
}

std::size_t SecureChannel::seal_answer(std::span<const std::byte> payload,
                                       std::span<std::byte> datagram) noexcept {
  const auto& through = came_beside_ ? beside_ : session_;
  return through ? through->seal(payload, datagram) : 0;
}

bool SecureChannel::take(std::span<const std::byte> datagram, const UdpAddress& from) noexcept {
  if (!part_of_handshake(datagram)) return false;
  DtlsOutgoing* slot = in_.slot();
  if (slot == nullptr) return true;
  slot->to = from;
  slot->size = datagram.size();
  std::copy(datagram.begin(), datagram.end(), slot->bytes.begin());
  in_.commit();
  return true;
}

const DtlsOutgoing* SecureChannel::outgoing() noexcept {
  if (sending_) out_.pop();
  const DtlsOutgoing* next = out_.front();
  sending_ = next != nullptr;
  return next;
}

void SecureChannel::service(TimePoint now) {
  for (const DtlsOutgoing* in = in_.front(); in != nullptr; in = in_.front()) {
    handshake_.receive(in->datagram(), in->to, now);
    in_.pop();
    pass_on();
  }
  handshake_.tick(now);
  keep_connected(now);
  pass_on();
  publish();
}

// A session made heard its peer, since its last flight is the peer's.
void SecureChannel::keep_connected(TimePoint now) {
  const std::uint64_t opened = opened_.load(std::memory_order_relaxed);
  if (opened != opened_before_) heard_ = now;
  opened_before_ = opened;
  if (auto made = handshake_.take_session()) {
    next_ = std::move(made);
    heard_ = now;
  }
  if (config_.server && (!heard_ || now - *heard_ > config_.silence))
    handshake_.start(*config_.server, now);
}

void SecureChannel::pass_on() {
  for (const DtlsOutgoing* out = handshake_.outgoing(); out != nullptr;
       out = handshake_.outgoing()) {
    DtlsOutgoing* slot = out_.slot();
    if (slot == nullptr) continue;
    *slot = *out;
    out_.commit();
  }
}

void send_handshake(SecureChannel* channel, UdpSocket& socket) noexcept {
  if (channel == nullptr) return;
  while (const DtlsOutgoing* out = channel->outgoing()) socket.send_to(out->datagram(), out->to);
}

void SecureChannel::publish() noexcept {
  if (made_.load(std::memory_order_acquire) != nullptr) return;
  delete retired_.exchange(nullptr, std::memory_order_relaxed);
  if (next_) made_.store(next_.release(), std::memory_order_release);
}

}  // namespace farhand
