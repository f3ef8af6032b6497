// Writes an MCAP file in chunks, each given to the system as soon as it is closed: what is not yet
// there when the program or the machine dies is at most kChunkSpan of log time.
//
// A write that fails (a full disk) costs the messages of its chunk, counted. What it had begun is
// cut off again, so the file stays good, and the next chunk tries anew; where cutting is
// impossible, nothing is written any more. Nothing after the constructor throws for what the disk
// does.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/mcap_format.hpp"

struct ZSTD_CCtx_s;

namespace farhand {

class McapWriter {
 public:
  static constexpr std::size_t kChunkBytes = 256u << 10;  // unpacked
  static constexpr std::chrono::nanoseconds kChunkSpan = std::chrono::milliseconds(250);

  // Makes or empties the file. Throws std::runtime_error with a sentence if it cannot be opened.
  McapWriter(const std::string& path, std::string_view library);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // What the file begins with; before the first message.
  void add_metadata(std::string_view name, const mcap::TextMap& map);
  void add_attachment(std::string_view name, std::string_view media_type, std::string_view data);
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);
  std::uint16_t add_channel(std::string_view topic, std::uint16_t schema,
                            std::string_view encoding);

  void write(std::uint16_t channel, std::uint64_t log_time_ns, std::string_view message);

  // The last chunk and the summary; nothing may be written after it.
  void close();

  std::uint64_t lost() const noexcept { return lost_; }         // messages
  const std::string& error() const noexcept { return error_; }  // the last one; "": none
  std::uint64_t file_bytes() const noexcept { return file_bytes_; }

 private:
  struct Channel {
    std::uint64_t messages = 0;                                  // in the file
    std::uint32_t sequence = 0;                                  // with the lost ones
    std::vector<std::pair<std::uint64_t, std::uint64_t>> chunk;  // time, offset
  };
  struct Span {
    std::uint64_t first = UINT64_MAX, last = 0;
    void add(std::uint64_t from, std::uint64_t to) noexcept;
  };

  void close_chunk();
  bool put_head();
  void pack_chunk();
  std::string index_chunk();
  std::string end() const;
  std::string statistics() const;
  bool append(std::string_view bytes);
  void take_back();

  int file_ = -1;
  std::uint64_t file_bytes_ = 0;
  std::uint32_t crc_ = 0;  // of all bytes in the file
  std::string head_;       // not yet in the file: everything before the first chunk
  std::string schema_records_, channel_records_;
  std::string attachment_index_, metadata_index_, chunk_index_;
  std::uint16_t schemas_ = 0;
  std::uint32_t attachments_ = 0, metadata_ = 0, chunks_ = 0;
  std::vector<Channel> channels_;  // the channel's number is its place, from 1
  std::string chunk_;              // records
  std::string packed_, block_;     // what they become, alone and with their indexes
  Span chunk_span_, span_;
  std::uint64_t lost_ = 0;
  bool closed_ = false;
  std::string error_;
  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> packer_;
};

}  // namespace farhand
