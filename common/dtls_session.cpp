#include <openssl/err.h>

#include <algorithm>

#include "common/dtls_connection.hpp"

namespace farhand {
namespace {

constexpr std::size_t kRecordOverhead = kDtlsHeaderBytes + kDtlsTagBytes;
// Where the fields of a record's header are; numbers are big endian.
constexpr std::size_t kVersionAt = 1, kEpochAt = 3, kRecordLengthAt = 11;
constexpr unsigned kDtls10 = 0xfeff, kDtls12 = 0xfefd;  // a first hello may say 1.0
constexpr unsigned kDataEpoch = 1;                      // after the only handshake

unsigned number(std::span<const std::byte> bytes, std::size_t at) noexcept {
  return std::to_integer<unsigned>(bytes[at]) << 8 | std::to_integer<unsigned>(bytes[at + 1]);
}

}  // namespace

Verdict judge_record(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() <= kRecordOverhead) return Verdict::too_short;
  if (datagram.size() > kMaxDatagramBytes) return Verdict::too_long;
  if (number(datagram, kVersionAt) != kDtls12) return Verdict::bad_magic;
  if (datagram[0] != std::byte{SSL3_RT_APPLICATION_DATA}) return Verdict::wrong_content;
  if (number(datagram, kEpochAt) != kDataEpoch) return Verdict::wrong_epoch;
  if (number(datagram, kRecordLengthAt) != datagram.size() - kDtlsHeaderBytes)
    return Verdict::bad_length;
  return Verdict::accepted;
}

bool part_of_handshake(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() <= kDtlsHeaderBytes || datagram.size() > kMaxDatagramBytes) return false;
  const unsigned version = number(datagram, kVersionAt);
  const auto type = std::to_integer<int>(datagram[0]);
  const unsigned epoch = number(datagram, kEpochAt);
  return (version == kDtls12 || version == kDtls10) &&
         number(datagram, kRecordLengthAt) <= datagram.size() - kDtlsHeaderBytes &&
         (type == SSL3_RT_HANDSHAKE
              ? epoch <= kDataEpoch
              : epoch == 0 && (type == SSL3_RT_CHANGE_CIPHER_SPEC || type == SSL3_RT_ALERT));
}

void prepare_dtls_thread() noexcept {
  ERR_clear_error();
}

DtlsSession::DtlsSession(std::unique_ptr<DtlsConnection> connection) noexcept
    : connection_(std::move(connection)) {}

DtlsSession::~DtlsSession() = default;

std::size_t DtlsSession::seal(std::span<const std::byte> payload,
                              std::span<std::byte> datagram) noexcept {
  if (payload.empty() || payload.size() > kMaxPayloadBytes ||
      payload.size() + kRecordOverhead > datagram.size())
    return 0;
  DtlsConnection& c = *connection_;
  c.written = 0;
  if (SSL_write(c.ssl.get(), payload.data(), static_cast<int>(payload.size())) <= 0) return 0;
  const auto& record = c.out[0];
  std::copy_n(record.bytes.begin(), record.size, datagram.begin());
  return record.size;
}

Opened DtlsSession::open(std::span<const std::byte> datagram,
                         std::span<std::byte> payload) noexcept {
  const Verdict verdict = judge_record(datagram);
  if (verdict != Verdict::accepted) return {verdict};
  DtlsConnection& c = *connection_;
  c.in = datagram;
  const int size = SSL_read(c.ssl.get(), payload.data(), static_cast<int>(payload.size()));
  c.in = {};
  if (size <= 0) return {Verdict::not_authentic};
  return {Verdict::accepted, static_cast<std::size_t>(size)};
}

}  // namespace farhand
