#include "tests/sim/keyed_channel.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "common/bytes.hpp"

namespace farhand {
namespace {

constexpr std::size_t kKindAt = 8, kNumberAt = 9, kPayloadAt = 17;

std::uint64_t mixed(std::uint64_t h, std::uint64_t word) noexcept {
  return Random(std::rotl(h, 23) ^ word).bits();
}

std::uint64_t checksum(std::uint64_t key, std::span<const std::byte> bytes) noexcept {
  std::uint64_t h = key ^ bytes.size();
  for (; bytes.size() >= 8; bytes = bytes.subspan(8))
    h = (std::rotl(h, 29) ^ load_little_endian<std::uint64_t>(bytes.data())) * 0x9e3779b97f4a7c15;
  for (const std::byte b : bytes)
    h = (std::rotl(h, 29) ^ std::to_integer<std::uint64_t>(b)) * 0xff51afd7ed558ccd;
  return mixed(h, key);
}

// The two directions must not be taken for one another.
std::uint64_t directed(std::uint64_t key, bool to_slave) noexcept {
  return to_slave ? key : ~key;
}

}  // namespace

std::size_t KeyedChannel::write(Frame& to, std::uint64_t key, Kind kind, std::uint64_t number,
                                std::span<const std::byte> payload) noexcept {
  const std::size_t size = kPayloadAt + payload.size();
  if (size > to.size()) return 0;
  to[kKindAt] = std::byte{kind};
  store_little_endian(number, &to[kNumberAt]);
  std::copy(payload.begin(), payload.end(), &to[kPayloadAt]);
  store_little_endian(
      checksum(directed(key, role_ == Role::master), std::span(to).first(size).subspan(kKindAt)),
      to.data());
  return size;
}

std::span<const std::byte> KeyedChannel::seal(std::span<const std::byte> datagram) noexcept {
  if (!present_) return {};
  return std::span(sealed_).first(write(sealed_, present_->key, kData, ++present_->sent, datagram));
}

std::span<const std::byte> KeyedChannel::due(TimePoint now) noexcept {
  if (role_ == Role::slave) return std::span(handshake_).first(std::exchange(reply_, 0));
  const bool heard = present_ && now - heard_ <= kSilence;
  if (heard || now < ask_at_) return {};
  ask_at_ = now + kAskAgain;
  asked_ = random_.bits();
  return std::span(handshake_).first(write(handshake_, kSharedKey, kRequest, asked_, {}));
}

std::span<const std::byte> KeyedChannel::open(std::span<const std::byte> frame,
                                              TimePoint now) noexcept {
  if (frame.size() < kPayloadAt || frame.size() > kMaxDatagramBytes) return {};
  const auto number = load_little_endian<std::uint64_t>(&frame[kNumberAt]);
  const auto payload = frame.subspan(kPayloadAt);
  if (frame[kKindAt] != std::byte{kData}) {
    Connection shared{.key = kSharedKey};
    if (!belongs(shared, frame, 0)) return {};
    if (role_ == Role::slave && frame[kKindAt] == std::byte{kRequest}) on_request(number);
    if (role_ == Role::master && frame[kKindAt] == std::byte{kReply} && payload.size() == 8)
      on_reply(number, load_little_endian<std::uint64_t>(payload.data()), now);
    return {};
  }
  if (present_ && belongs(*present_, frame, number)) {
    heard_ = now;
    return payload;
  }
  if (!next_ || !belongs(*next_, frame, number)) return {};
  present_ = std::exchange(next_, {});
  return payload;
}

void KeyedChannel::on_request(std::uint64_t nonce) noexcept {
  const std::uint64_t own = random_.bits();
  next_ = Connection{.key = mixed(mixed(kSharedKey, nonce), own)};
  std::array<std::byte, 8> payload;
  store_little_endian(own, payload.data());
  reply_ = write(handshake_, kSharedKey, kReply, nonce, payload);
}

void KeyedChannel::on_reply(std::uint64_t nonce, std::uint64_t peers, TimePoint now) noexcept {
  if (asked_ == 0 || nonce != asked_) return;
  asked_ = 0;
  present_ = Connection{.key = mixed(mixed(kSharedKey, nonce), peers)};
  heard_ = now;
}

bool KeyedChannel::belongs(Connection& c, std::span<const std::byte> frame,
                           std::uint64_t number) noexcept {
  if (load_little_endian<std::uint64_t>(frame.data()) !=
      checksum(directed(c.key, role_ == Role::slave), frame.subspan(kKindAt)))
    return false;
  const auto place = c.seen.admit(number);
  return place == SequenceWindow::Place::newest || place == SequenceWindow::Place::late;
}

}  // namespace farhand
