// The bytes of an MCAP file (the format's specification is at https://mcap.dev/spec): numbers are
// little endian, a text has its length in 32 bits before it, and a file is
//
//   magic, records, magic        a record: opcode (1 byte), length of its content (8 bytes),
//   content
//
// Header, metadata, attachment, schemas and channels come first, then chunks of messages with their
// indexes, DataEnd with a CRC of all before it, the summary, and the Footer with a CRC of the
// summary. CRCs are CRC-32 (IEEE 802.3), 0: none.
#pragma once

#include <zlib.h>

#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "common/bytes.hpp"

namespace farhand::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::size_t kRecordHeadBytes = 9;  // opcode, length
inline constexpr std::size_t kFooterBytes = kRecordHeadBytes + 20;

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

using TextMap = std::map<std::string, std::string>;

// CRC-32 of `before`'s bytes and these.
inline std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0) noexcept {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

template <std::unsigned_integral T>
void put(std::string& out, T x) {
  std::byte bytes[sizeof(T)];
  store_little_endian(x, bytes);
  out.append(reinterpret_cast<const char*>(bytes), sizeof(T));
}

template <std::unsigned_integral Length = std::uint32_t>
void put_text(std::string& out, std::string_view text) {
  put(out, static_cast<Length>(text.size()));
  out += text;
}

// A record, or anything else with its length before it: `fill` appends the content.
template <std::unsigned_integral Length, typename Fill>
void put_sized(std::string& out, Fill&& fill) {
  const std::size_t at = out.size();
  put(out, Length{0});
  fill();
  store_little_endian(static_cast<Length>(out.size() - at - sizeof(Length)),
                      reinterpret_cast<std::byte*>(out.data() + at));
}
template <typename Fill>
void put_record(std::string& out, Op op, Fill&& fill) {
  put(out, static_cast<std::uint8_t>(op));
  put_sized<std::uint64_t>(out, fill);
}
inline void put_map(std::string& out, const TextMap& map) {
  put_sized<std::uint32_t>(out, [&] {
    for (const auto& [key, value] : map) put_text(out, key), put_text(out, value);
  });
}

// Takes a record's fields one after another. Past its end everything is zero or empty and good() is
// false, for good.
class Fields {
 public:
  Fields() = default;
  explicit Fields(std::string_view bytes) noexcept : left_(bytes) {}

  template <std::unsigned_integral T>
  T number() noexcept {
    const std::string_view bytes = take(sizeof(T));
    return bytes.empty() ? T{0}
                         : load_little_endian<T>(reinterpret_cast<const std::byte*>(bytes.data()));
  }
  std::string_view take(std::uint64_t size) noexcept {
    if (size > left_.size()) {
      good_ = false;
      left_ = {};
      return {};
    }
    const std::string_view taken = left_.substr(0, static_cast<std::size_t>(size));
    left_.remove_prefix(taken.size());
    return taken;
  }
  template <std::unsigned_integral Length = std::uint32_t>
  std::string_view text() noexcept {
    return take(number<Length>());
  }
  TextMap map() {
    TextMap out;
    Fields entries(text());
    while (entries.size() > 0) {
      std::string key(entries.text());
      out[std::move(key)] = entries.text();
    }
    good_ = good_ && entries.good_;
    return out;
  }
  std::string_view rest() noexcept { return take(left_.size()); }
  std::size_t size() const noexcept { return left_.size(); }
  bool good() const noexcept { return good_; }
  bool spent() const noexcept { return good_ && left_.empty(); }

 private:
  std::string_view left_;
  bool good_ = true;
};

}  // namespace farhand::mcap
