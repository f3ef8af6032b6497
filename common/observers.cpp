#include "common/observers.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/channel.hpp"

namespace farhand {

std::array<std::byte, kQuestionBytes> question() noexcept {
  std::array<std::byte, kQuestionBytes> out{};
  out[0] = kQuestion;
  return out;
}

Observers::Observers(const std::optional<Credentials>& credentials, Send send)
    : send_(std::move(send)) {
  if (credentials)
    handshake_ = std::make_unique<DtlsHandshake>(DtlsRole::server, *credentials,
                                                 DtlsConfig{.observers = true});
}

void Observers::show(std::string_view status) {
  if (status.size() >= answer_.size()) throw std::length_error("a status longer than its question");
  answer_[0] = kAnswer;
  std::transform(status.begin(), status.end(), answer_.begin() + 1,
                 [](char c) { return static_cast<std::byte>(c); });
  answer_size_ = status.size() + 1;
}

void Observers::receive(std::span<const std::byte> datagram, const UdpAddress& from,
                        TimePoint now) {
  if (!handshake_) {
    if (!asks(open(datagram, payload_))) return;
    const auto size = seal(std::span(answer_).first(answer_size_), datagram_);
    return send_(std::span(datagram_).first(size), from);
  }
  if (part_of_handshake(datagram)) return handshake(datagram, from, now);
  Connection* c = connection(from);
  if (c == nullptr || !asks(c->session->open(datagram, payload_))) return;
  c->heard = now;
  const auto size = c->session->seal(std::span(answer_).first(answer_size_), datagram_);
  send_(std::span(datagram_).first(size), from);
}

void Observers::tick(TimePoint now) {
  if (!handshake_) return;
  handshake_->tick(now);
  pass_on();
}

bool Observers::asks(const Opened& opened) const noexcept {
  return opened.verdict == Verdict::accepted && opened.size == kQuestionBytes &&
         payload_[0] == kQuestion && answer_size_ > 0;
}

Observers::Connection* Observers::connection(const UdpAddress& to) noexcept {
  const auto at = std::find_if(connections_.begin(), connections_.end(),
                               [&](const Connection& c) { return c.session && c.to == to; });
  return at == connections_.end() ? nullptr : &*at;
}

// A session is made by a datagram of its own client.
void Observers::handshake(std::span<const std::byte> datagram, const UdpAddress& from,
                          TimePoint now) {
  handshake_->receive(datagram, from, now);
  pass_on();
  auto made = handshake_->take_session();
  if (!made) return;
  Connection* place = connection(from);
  if (place == nullptr)
    place = &*std::min_element(
        connections_.begin(), connections_.end(),
        [](const Connection& a, const Connection& b) { return a.heard < b.heard; });
  *place = {from, std::move(made), now};
}

void Observers::pass_on() {
  while (const DtlsOutgoing* out = handshake_->outgoing()) send_(out->datagram(), out->to);
}

}  // namespace farhand
