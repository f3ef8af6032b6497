// Shows a status to those who only look. Each who asks is answered with the newest one; who looks
// therefore sets the pace. Nothing that is asked reaches anything but the answer.
//
// A question is padded to kQuestionBytes and no answer is longer: nobody gets more bytes than he
// sent. With credentials both are sealed by DTLS, in connections of their own, and nobody without
// them is answered; without any nothing is kept of anybody. No socket and no clock. It allocates
// and takes its time in handshakes, so not for a loop.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "common/dtls.hpp"

namespace farhand {

// First bytes of the two payloads; none is a payload of the link.
inline constexpr std::byte kQuestion{16}, kAnswer{17};
inline constexpr std::size_t kQuestionBytes = 256;

// A question and nothing but zeros behind it.
std::array<std::byte, kQuestionBytes> question() noexcept;

class Observers {
 public:
  using Send = std::function<void(std::span<const std::byte>, const UdpAddress&)>;
  static constexpr std::size_t kMost = 8;  // connections; the one silent for longest goes first

  // Without credentials: plain datagrams. Throws as DtlsHandshake does.
  Observers(const std::optional<Credentials>& credentials, Send send);

  // What questions are answered with from now on: a serialised Shown. Throws if it is longer than a
  // question.
  void show(std::string_view status);
  void receive(std::span<const std::byte> datagram, const UdpAddress& from, TimePoint now);
  // What time alone brings about; every few ten milliseconds.
  void tick(TimePoint now);

 private:
  struct Connection {
    UdpAddress to;
    std::unique_ptr<DtlsSession> session;
    TimePoint heard{};
  };
  Connection* connection(const UdpAddress& to) noexcept;
  void handshake(std::span<const std::byte> datagram, const UdpAddress& from, TimePoint now);
  void pass_on();
  bool asks(const Opened& opened) const noexcept;

  Send send_;
  std::unique_ptr<DtlsHandshake> handshake_;
  std::array<Connection, kMost> connections_;
  std::array<std::byte, kQuestionBytes> answer_{};
  std::size_t answer_size_ = 0;
  std::array<std::byte, kMaxPayloadBytes> payload_{};
  std::array<std::byte, kMaxDatagramBytes> datagram_{};
};

}  // namespace farhand
