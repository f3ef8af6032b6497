// A small MCAP file with known messages, and a file read back whole.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "common/mcap_reader.hpp"
#include "common/mcap_writer.hpp"
#include "common/random.hpp"

namespace farhand {

struct ExampleMessage {
  std::uint64_t log_time_ns = 0;
  std::string topic, schema, data;
  bool operator==(const ExampleMessage&) const = default;
};

inline std::string noise(std::uint64_t seed, std::size_t size) {
  Random random(seed);
  std::string out(size, 0);
  for (char& c : out) c = static_cast<char>(random.bits());
  return out;
}

// The i-th millisecond's message.
inline ExampleMessage example_message(std::uint64_t i, const std::string& topic) {
  return {i * 1'000'000, topic, "Example", topic + std::to_string(i) + noise(i, 20)};
}

// `count` messages on /fast and every second time one on /slow. Returns how many were lost.
inline std::uint64_t write_example(const std::string& path, std::uint64_t count) {
  McapWriter writer(path, "test");
  writer.add_metadata("about", {{"role", "test"}, {"empty", ""}});
  writer.add_attachment("note.txt", "text/plain", "as it was");
  const auto schema = writer.add_schema("Example", "none", "what a schema says");
  const auto fast = writer.add_channel("/fast", schema, "text");
  const auto slow = writer.add_channel("/slow", schema, "text");
  for (std::uint64_t i = 0; i < count; ++i) {
    writer.write(fast, i * 1'000'000, example_message(i, "/fast").data);
    if (i % 2 == 0) writer.write(slow, i * 1'000'000, example_message(i, "/slow").data);
  }
  writer.close();
  return writer.lost();
}

struct ReadBack {
  std::vector<ExampleMessage> messages;
  std::map<std::string, mcap::TextMap> metadata;
  std::map<std::string, std::string> attachments;
  bool complete = false;
  std::uint64_t damaged_chunks = 0;
  std::vector<std::string> damage;

  bool sound() const { return complete && damage.empty(); }
};

inline ReadBack read_back(const std::string& path) {
  McapReader reader(path);
  ReadBack out;
  for (McapReader::Message m; reader.next(m);)
    out.messages.push_back(
        {m.log_time_ns, std::string(m.topic), std::string(m.schema),
         std::string(reinterpret_cast<const char*>(m.data.data()), m.data.size())});
  out.metadata = reader.metadata();
  out.attachments = reader.attachments();
  out.complete = reader.complete();
  out.damaged_chunks = reader.damaged_chunks();
  out.damage = reader.damage();
  return out;
}

inline std::string bytes_of(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}
inline void put_bytes(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace farhand
