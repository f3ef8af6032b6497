#include "common/mcap_writer.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace farhand {

using mcap::Op;
using mcap::put;
using mcap::put_map;
using mcap::put_record;
using mcap::put_sized;
using mcap::put_text;

namespace {

constexpr std::string_view kCompression = "zstd";
constexpr int kCompressionLevel = 1;

}  // namespace

void McapWriter::Span::add(std::uint64_t from, std::uint64_t to) noexcept {
  first = std::min(first, from);
  last = std::max(last, to);
}

McapWriter::McapWriter(const std::string& path, std::string_view library)
    : file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)),
      head_(mcap::kMagic),
      packer_(ZSTD_createCCtx(), ZSTD_freeCCtx) {
  if (file_ < 0)
    throw std::runtime_error(path + " cannot be opened for recording: " + std::strerror(errno));
  put_record(head_, Op::header, [&] { put_text(head_, ""), put_text(head_, library); });
}

McapWriter::~McapWriter() {
  close();
}

void McapWriter::add_metadata(std::string_view name, const mcap::TextMap& map) {
  const std::size_t at = head_.size();
  put_record(head_, Op::metadata, [&] { put_text(head_, name), put_map(head_, map); });
  put_record(metadata_index_, Op::metadata_index, [&] {
    put(metadata_index_, std::uint64_t{at});
    put(metadata_index_, std::uint64_t{head_.size() - at});
    put_text(metadata_index_, name);
  });
  ++metadata_;
}

void McapWriter::add_attachment(std::string_view name, std::string_view media_type,
                                std::string_view data) {
  const std::size_t at = head_.size();
  const auto put_times = [](std::string& out) {
    put(out, std::uint64_t{0});  // logged and created before the first message
    put(out, std::uint64_t{0});
  };
  put_record(head_, Op::attachment, [&] {
    const std::size_t content = head_.size();
    put_times(head_);
    put_text(head_, name), put_text(head_, media_type), put_text<std::uint64_t>(head_, data);
    put(head_, mcap::crc32(std::string_view(head_).substr(content)));
  });
  put_record(attachment_index_, Op::attachment_index, [&] {
    put(attachment_index_, std::uint64_t{at});
    put(attachment_index_, std::uint64_t{head_.size() - at});
    put_times(attachment_index_);
    put(attachment_index_, std::uint64_t{data.size()});
    put_text(attachment_index_, name), put_text(attachment_index_, media_type);
  });
  ++attachments_;
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                     std::string_view data) {
  put_record(schema_records_, Op::schema, [&] {
    put(schema_records_, ++schemas_);
    put_text(schema_records_, name), put_text(schema_records_, encoding);
    put_text(schema_records_, data);
  });
  return schemas_;
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::uint16_t schema,
                                      std::string_view encoding) {
  channels_.emplace_back();
  const auto id = static_cast<std::uint16_t>(channels_.size());
  put_record(channel_records_, Op::channel, [&] {
    put(channel_records_, id), put(channel_records_, schema);
    put_text(channel_records_, topic), put_text(channel_records_, encoding);
    put_map(channel_records_, {});
  });
  return id;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time_ns, std::string_view message) {
  const auto span = static_cast<std::uint64_t>(kChunkSpan.count());
  if (!chunk_.empty() && log_time_ns >= chunk_span_.first + span) close_chunk();
  Channel& to = channels_.at(channel - 1u);
  to.chunk.emplace_back(log_time_ns, chunk_.size());
  chunk_span_.add(log_time_ns, log_time_ns);
  put_record(chunk_, Op::message, [&] {
    put(chunk_, channel), put(chunk_, to.sequence++);
    put(chunk_, log_time_ns), put(chunk_, log_time_ns);
    chunk_ += message;
  });
  if (chunk_.size() >= kChunkBytes) close_chunk();
}

void McapWriter::close_chunk() {
  if (chunk_.empty()) return;
  bool kept = put_head();
  if (kept) {
    pack_chunk();
    const std::string index = index_chunk();
    kept = append(block_);
    if (kept) chunk_index_ += index;
  }
  for (Channel& c : channels_) {
    (kept ? c.messages : lost_) += c.chunk.size();
    c.chunk.clear();
  }
  if (kept) ++chunks_, span_.add(chunk_span_.first, chunk_span_.last);
  chunk_.clear();
  chunk_span_ = {};
}

bool McapWriter::put_head() {
  if (!head_.empty() && append(head_ + schema_records_ + channel_records_)) head_.clear();
  return head_.empty();
}

void McapWriter::pack_chunk() {
  block_.clear();
  packed_.resize(ZSTD_compressBound(chunk_.size()));
  const std::size_t size = ZSTD_compressCCtx(packer_.get(), packed_.data(), packed_.size(),
                                             chunk_.data(), chunk_.size(), kCompressionLevel);
  packed_.resize(size);  // compression into a buffer of that bound cannot fail
  put_record(block_, Op::chunk, [&] {
    put(block_, chunk_span_.first), put(block_, chunk_span_.last);
    put(block_, std::uint64_t{chunk_.size()}), put(block_, mcap::crc32(chunk_));
    put_text(block_, kCompression), put_text<std::uint64_t>(block_, packed_);
  });
}

// Appends where each channel's messages are to the block; returns what the summary says of it.
std::string McapWriter::index_chunk() {
  const std::uint64_t chunk_bytes = block_.size();
  std::string offsets, out;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].chunk.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    put(offsets, id), put(offsets, file_bytes_ + block_.size());
    put_record(block_, Op::message_index, [&] {
      put(block_, id);
      put_sized<std::uint32_t>(block_, [&] {
        for (const auto& [time, offset] : channels_[i].chunk)
          put(block_, time), put(block_, offset);
      });
    });
  }
  put_record(out, Op::chunk_index, [&] {
    put(out, chunk_span_.first), put(out, chunk_span_.last);
    put(out, file_bytes_), put(out, chunk_bytes);
    put_text(out, offsets), put(out, block_.size() - chunk_bytes);
    put_text(out, kCompression);
    put(out, std::uint64_t{packed_.size()}), put(out, std::uint64_t{chunk_.size()});
  });
  return out;
}

void McapWriter::close() {
  if (closed_) return;
  closed_ = true;
  close_chunk();
  if (put_head()) append(end());
  if (file_ >= 0 && ::close(file_) != 0) error_ = std::strerror(errno);
  file_ = -1;
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  for (const Channel& c : channels_) messages += c.messages;
  std::string out;
  put_record(out, Op::statistics, [&] {
    put(out, messages), put(out, schemas_);
    put(out, static_cast<std::uint32_t>(channels_.size()));
    put(out, attachments_), put(out, metadata_), put(out, chunks_);
    put(out, messages == 0 ? 0 : span_.first), put(out, span_.last);
    put_sized<std::uint32_t>(out, [&] {
      for (std::size_t i = 0; i < channels_.size(); ++i)
        put(out, static_cast<std::uint16_t>(i + 1)), put(out, channels_[i].messages);
    });
  });
  return out;
}

// DataEnd, summary with where its groups are, Footer, magic.
std::string McapWriter::end() const {
  const std::string counts = statistics();
  const struct {
    Op op;
    std::string_view records;
  } groups[] = {{Op::schema, schema_records_},
                {Op::channel, channel_records_},
                {Op::statistics, counts},
                {Op::chunk_index, chunk_index_},
                {Op::attachment_index, attachment_index_},
                {Op::metadata_index, metadata_index_}};
  std::string out, offsets;
  put_record(out, Op::data_end, [&] { put(out, crc_); });
  const std::size_t summary = out.size();
  for (const auto& group : groups) {
    if (group.records.empty()) continue;
    put_record(offsets, Op::summary_offset, [&] {
      put(offsets, static_cast<std::uint8_t>(group.op));
      put(offsets, file_bytes_ + out.size()), put(offsets, std::uint64_t{group.records.size()});
    });
    out += group.records;
  }
  const std::uint64_t offsets_at = file_bytes_ + out.size();
  out += offsets;
  // By hand, since the CRC covers the length before it.
  put(out, static_cast<std::uint8_t>(Op::footer));
  put(out, std::uint64_t{mcap::kFooterBytes - mcap::kRecordHeadBytes});
  put(out, file_bytes_ + summary), put(out, offsets_at);
  put(out, mcap::crc32(std::string_view(out).substr(summary)));
  return out.append(mcap::kMagic);
}

bool McapWriter::append(std::string_view bytes) {
  std::string_view left = bytes;
  while (!left.empty() && file_ >= 0) {
    const ssize_t put = ::write(file_, left.data(), left.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      error_ = std::strerror(errno);
      if (left.size() < bytes.size()) take_back();
      return false;
    }
    left.remove_prefix(static_cast<std::size_t>(put));
  }
  if (!left.empty()) return false;
  file_bytes_ += bytes.size();
  crc_ = mcap::crc32(bytes, crc_);
  return true;
}

// Cuts off what append() had begun, or gives up the file.
void McapWriter::take_back() {
  const auto size = static_cast<off_t>(file_bytes_);
  if (ftruncate(file_, size) == 0 && lseek(file_, size, SEEK_SET) == size) return;
  ::close(file_);
  file_ = -1;
}

}  // namespace farhand
