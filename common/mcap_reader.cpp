#include "common/mcap_reader.hpp"

#include <spdlog/fmt/fmt.h>
#include <zstd.h>

#include <filesystem>
#include <stdexcept>

namespace farhand {

using mcap::Fields;
using mcap::Op;

McapReader::McapReader(const std::string& path) : file_(path, std::ios::binary) {
  std::error_code error;
  if (!file_ || !std::filesystem::is_regular_file(path, error))
    throw std::runtime_error(path + " cannot be opened: give a recording that exists");
  file_bytes_ = std::filesystem::file_size(path, error);
  std::string magic;
  if (!read_bytes(magic, mcap::kMagic.size()) || magic != mcap::kMagic)
    throw std::runtime_error(path + " is no MCAP file: its first bytes are others");
  Message none;
  while (read_record()) {
    if (at_ - record_.size() == mcap::kMagic.size() + mcap::kRecordHeadBytes && op_ != Op::header)
      damaged("the header is missing");
    pending_ = op_ == Op::chunk || op_ == Op::message || op_ == Op::data_end;
    if (pending_) return;
    take_record(none);
  }
}

bool McapReader::next(Message& message) {
  for (;;) {
    if (chunk_.size() > 0) {
      if (take_from_chunk(message)) return true;
    } else {
      if (ended_ || (!pending_ && !read_record())) return false;
      pending_ = false;
      if (take_record(message)) return true;
    }
  }
}

bool McapReader::read_bytes(std::string& to, std::uint64_t size) {
  if (size > file_bytes_ - at_) return false;
  to.resize(static_cast<std::size_t>(size));
  file_.read(to.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(file_.gcount()) != size) return false;
  at_ += size;
  crc_ = mcap::crc32(to, crc_);
  return true;
}

bool McapReader::read_record() {
  record_at_ = at_;
  crc_before_ = crc_;
  ended_ = true;  // unless all of it is there
  if (!read_bytes(record_, mcap::kRecordHeadBytes)) return false;
  Fields head(record_);
  op_ = static_cast<Op>(head.number<std::uint8_t>());
  const auto length = head.number<std::uint64_t>();
  if (length > kLargestRecord) {
    damaged(fmt::format("a record of {} bytes", length));
    return false;
  }
  ended_ = !read_bytes(record_, length);
  return !ended_;
}

bool McapReader::take_record(Message& message) {
  bool good = true;
  switch (op_) {
    case Op::header:
      good = record_at_ == mcap::kMagic.size();
      break;
    case Op::chunk:
      open_chunk();
      break;
    case Op::message_index:
      break;
    case Op::attachment:
      good = take_attachment();
      break;
    case Op::metadata:
      good = take_metadata();
      break;
    case Op::data_end:
      ended_ = true;
      read_summary();
      break;
    default: {
      const Found found = take_content(op_, record_, message);
      if (found == Found::message) return true;
      good = found == Found::other;
    }
  }
  if (!good) damaged(fmt::format("a record of type {} is damaged", static_cast<int>(op_)));
  return false;
}

// What a chunk may hold, and what may also stand outside of one.
McapReader::Found McapReader::take_content(Op op, std::string_view content, Message& message) {
  constexpr int kFirstUnknown = 0x10;
  Fields f(content);
  if (op == Op::message) return take_message(f, message);
  if (op == Op::schema) {
    const auto id = f.number<std::uint16_t>();
    const Schema schema{std::string(f.text()), std::string(f.text()), std::string(f.text())};
    const bool good =
        f.spent() && id != 0 && schemas_.try_emplace(id, schema).first->second == schema;
    return good ? Found::other : Found::bad;
  }
  if (op == Op::channel) {
    const auto id = f.number<std::uint16_t>();
    const auto schema = f.number<std::uint16_t>();
    const Channel channel{schema, std::string(f.text()), std::string(f.text())};
    f.map();
    const bool good = f.spent() && (schema == 0 || schemas_.contains(schema)) &&
                      channels_.try_emplace(id, channel).first->second == channel;
    return good ? Found::other : Found::bad;
  }
  return static_cast<int>(op) >= kFirstUnknown ? Found::other : Found::bad;
}

McapReader::Found McapReader::take_message(Fields& f, Message& message) {
  const auto channel = channels_.find(f.number<std::uint16_t>());
  f.number<std::uint32_t>();  // sequence
  message.log_time_ns = f.number<std::uint64_t>();
  f.number<std::uint64_t>();  // publish time
  const std::string_view data = f.rest();
  if (!f.good() || channel == channels_.end()) return Found::bad;
  message.data = std::as_bytes(std::span(data));
  message.topic = channel->second.topic;
  const auto schema = schemas_.find(channel->second.schema);
  message.schema = schema == schemas_.end() ? std::string_view{} : schema->second.name;
  ++messages_;
  return Found::message;
}

bool McapReader::take_from_chunk(Message& message) {
  const Op op = static_cast<Op>(chunk_.number<std::uint8_t>());
  const std::string_view content = chunk_.text<std::uint64_t>();
  const Found found = chunk_.good() ? take_content(op, content, message) : Found::bad;
  const bool in_time = message.log_time_ns >= chunk_start_ && message.log_time_ns <= chunk_end_;
  if (found == Found::message && in_time) return true;
  if (found != Found::other) damaged_chunk();
  return false;
}

void McapReader::open_chunk() {
  Fields f(record_);
  chunk_start_ = f.number<std::uint64_t>();
  chunk_end_ = f.number<std::uint64_t>();
  const auto size = f.number<std::uint64_t>();
  const auto crc = f.number<std::uint32_t>();
  const std::string_view compression = f.text();
  const std::string_view content = unpack(compression, f.text<std::uint64_t>(), size);
  const bool good =
      f.spent() && content.size() == size && (crc == 0 || mcap::crc32(content) == crc);
  if (good)
    chunk_ = Fields(content);
  else
    damaged_chunk();
}

// Never more than `size` bytes, whatever is packed in there.
std::string_view McapReader::unpack(std::string_view compression, std::string_view bytes,
                                    std::uint64_t size) {
  if (compression.empty()) return bytes;
  if (compression != "zstd" || size > kLargestRecord) return {};
  unpacked_.resize(static_cast<std::size_t>(size));
  const std::size_t got =
      ZSTD_decompress(unpacked_.data(), unpacked_.size(), bytes.data(), bytes.size());
  return ZSTD_isError(got) != 0 ? std::string_view{} : std::string_view(unpacked_).substr(0, got);
}

bool McapReader::take_attachment() {
  Fields f(record_);
  f.number<std::uint64_t>();  // log time
  f.number<std::uint64_t>();  // time of creation
  const std::string name(f.text());
  f.text();  // media type
  const std::string_view data = f.text<std::uint64_t>();
  const std::size_t covered = record_.size() - f.size();
  const auto crc = f.number<std::uint32_t>();
  if (!f.spent()) return false;
  if (crc != 0 && mcap::crc32(std::string_view(record_).substr(0, covered)) != crc) return false;
  attachments_[name] = data;
  return true;
}

bool McapReader::take_metadata() {
  Fields f(record_);
  const std::string name(f.text());
  mcap::TextMap map = f.map();
  if (!f.spent()) return false;
  metadata_[name] = std::move(map);
  return true;
}

void McapReader::read_summary() {
  Fields end(record_);
  const auto crc = end.number<std::uint32_t>();
  if (!end.spent() || (crc != 0 && crc != crc_before_)) damaged("the data's CRC is wrong");
  const std::uint64_t start = at_;
  std::string tail;
  if (file_bytes_ - at_ > kLargestRecord || !read_bytes(tail, file_bytes_ - at_)) return;
  complete_ =
      tail.size() >= mcap::kFooterBytes + mcap::kMagic.size() && tail.ends_with(mcap::kMagic);
  if (!complete_) return;
  tail.resize(tail.size() - mcap::kMagic.size());
  if (!summary_good(tail, start)) damaged("the summary is damaged");
}

bool McapReader::summary_good(std::string_view tail, std::uint64_t start) const {
  const std::size_t size = tail.size() - mcap::kFooterBytes;
  Fields footer(tail.substr(size));
  if (static_cast<Op>(footer.number<std::uint8_t>()) != Op::footer) return false;
  Fields f(footer.text<std::uint64_t>());
  if (f.number<std::uint64_t>() != (size == 0 ? 0 : start)) return false;
  f.number<std::uint64_t>();  // where the offsets start
  const auto crc = f.number<std::uint32_t>();
  if (!f.spent() || !footer.spent()) return false;
  if (crc != 0 && mcap::crc32(tail.substr(0, tail.size() - sizeof crc)) != crc) return false;
  Fields records(tail.substr(0, size));
  while (records.size() > 0) {
    const Op op = static_cast<Op>(records.number<std::uint8_t>());
    Fields content(records.text<std::uint64_t>());
    const bool counted = op == Op::statistics && damaged_chunks_ == 0;
    if (counted && content.number<std::uint64_t>() != messages_) return false;
  }
  return records.good();
}

void McapReader::damaged_chunk() {
  ++damaged_chunks_;
  chunk_ = {};
  damaged("a chunk is damaged");
}

void McapReader::damaged(const std::string& what) {
  constexpr std::size_t kKept = 20;
  if (damage_.size() < kKept) damage_.push_back(fmt::format("from byte {}: {}", record_at_, what));
}

}  // namespace farhand
