// Reads an MCAP file from its begin to its end, whole or cut off anywhere, ours or another
// writer's. No bytes make it crash or use more memory than the limits below; what is damaged is
// told, never passed on: a chunk whose CRC is wrong is left out, and once next() has returned false
// every changed bit of a file of ours has shown up in damage() or made complete() false.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/mcap_format.hpp"

namespace farhand {

class McapReader {
 public:
  // Records beyond it, chunks unpacked or not, are refused as damaged.
  static constexpr std::uint64_t kLargestRecord = 64u << 20;

  struct Message {
    std::uint64_t log_time_ns = 0;
    std::string_view topic;
    std::string_view schema;  // its name
    std::span<const std::byte> data;
  };

  // Reads up to the first chunk, so that metadata and attachments are known at once. Throws
  // std::runtime_error with a sentence if it is no MCAP file.
  explicit McapReader(const std::string& path);

  // False at the end. Views are valid until the next call.
  bool next(Message& message);

  const std::map<std::string, mcap::TextMap>& metadata() const noexcept { return metadata_; }
  const std::map<std::string, std::string>& attachments() const noexcept { return attachments_; }

  // After next() has returned false. complete(): the file ends as it should; otherwise it is cut
  // off, or damaged so that nothing behind could be read.
  bool complete() const noexcept { return complete_; }
  std::uint64_t damaged_chunks() const noexcept { return damaged_chunks_; }
  // A sentence each, the first ones; empty: nothing is wrong with what is there.
  const std::vector<std::string>& damage() const noexcept { return damage_; }

  std::uint64_t bytes_read() const noexcept { return at_; }
  std::uint64_t file_bytes() const noexcept { return file_bytes_; }

 private:
  struct Schema {
    std::string name, encoding, data;
    bool operator==(const Schema&) const = default;
  };
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic, encoding;
    bool operator==(const Channel&) const = default;
  };
  enum class Found { message, other, bad };

  bool read_bytes(std::string& to, std::uint64_t size);
  bool read_record();
  bool take_record(Message& message);
  bool take_from_chunk(Message& message);
  Found take_content(mcap::Op op, std::string_view content, Message& message);
  Found take_message(mcap::Fields& fields, Message& message);
  void open_chunk();
  std::string_view unpack(std::string_view compression, std::string_view bytes, std::uint64_t size);
  bool take_attachment();
  bool take_metadata();
  void read_summary();
  bool summary_good(std::string_view tail, std::uint64_t start) const;
  void damaged_chunk();
  void damaged(const std::string& what);

  std::ifstream file_;
  std::uint64_t file_bytes_ = 0, at_ = 0;
  std::uint64_t record_at_ = 0;   // where the record below begins
  std::uint32_t crc_before_ = 0;  // of everything before that
  std::uint32_t crc_ = 0;         // of everything before at_
  mcap::Op op_{};
  std::string record_, unpacked_;
  bool pending_ = false;  // the record is read, but not yet taken
  bool ended_ = false;
  mcap::Fields chunk_;  // what is left of the open one
  std::uint64_t chunk_start_ = 0, chunk_end_ = 0;

  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::string, mcap::TextMap> metadata_;
  std::map<std::string, std::string> attachments_;
  std::uint64_t messages_ = 0;
  bool complete_ = false;
  std::uint64_t damaged_chunks_ = 0;
  std::vector<std::string> damage_;
};

}  // namespace farhand
