#include "common/mcap_reader.hpp"

#include <gtest/gtest.h>

#include "tests/support/mcap_files.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

class McapReaderTest : public ::testing::Test {
 protected:
  McapReaderTest() {
    write_example(file_.path(), 1200);
    whole_ = bytes_of(file_.path());
  }
  // Of the file with these bytes; refused counts as noticed.
  ReadBack read(std::string_view bytes) {
    put_bytes(file_.path(), bytes);
    try {
      return read_back(file_.path());
    } catch (const std::runtime_error&) {
      ++refused_;
      return {};
    }
  }
  std::size_t below(std::size_t n) { return random_.bits() % n; }

  TemporaryFile file_{"", ".mcap"};
  std::string whole_;
  Random random_{20};
  int refused_ = 0;
};

TEST_F(McapReaderTest, EveryFlippedBitIsNoticed) {
  ASSERT_TRUE(read(whole_).sound());
  for (int i = 0; i < 1000; ++i) {
    std::string bytes = whole_;
    // Half of them in the few bytes outside of chunks.
    const std::size_t at = i % 2 == 0   ? below(bytes.size())
                           : i % 4 == 1 ? below(500)
                                        : bytes.size() - 1 - below(1500);
    const int bit = static_cast<int>(below(8));
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    EXPECT_FALSE(read(bytes).sound()) << "byte " << at << " bit " << bit;
  }
}

TEST_F(McapReaderTest, AFlippedBitCostsAtMostItsChunk) {
  for (int i = 0; i < 100; ++i) {
    std::string bytes = whole_;
    const std::size_t chunk = whole_.find(std::string("zstd"), 1000 + below(20'000)) + 100;
    bytes[chunk] = static_cast<char>(bytes[chunk] ^ 1);
    const ReadBack back = read(bytes);
    EXPECT_EQ(back.damaged_chunks, 1u) << "byte " << chunk;
    EXPECT_TRUE(back.complete);
    EXPECT_EQ(back.messages.size(), 1800u - 375u) << "byte " << chunk;
  }
}

TEST_F(McapReaderTest, ACutFileKeepsAllButTheLastHalfSecondBeforeTheCut) {
  // Log time of the last message that begins before each byte: where the chunks end in the file.
  std::vector<std::pair<std::size_t, std::uint64_t>> ends;
  {
    const TemporaryFile growing("", ".mcap");
    McapWriter writer(growing.path(), "test");
    const auto channel = writer.add_channel("/a", 0, "text");
    for (std::uint64_t i = 0; i < 3000; ++i) {
      ends.emplace_back(writer.file_bytes(), i);
      writer.write(channel, i * 1'000'000, noise(i, 100));
    }
    writer.close();
    whole_ = bytes_of(growing.path());
  }
  for (int i = 0; i < 100; ++i) {
    const std::size_t cut = 8 + below(whole_.size() - 8);
    const ReadBack back = read(std::string_view(whole_).substr(0, cut));
    EXPECT_FALSE(back.complete) << "cut at " << cut;
    EXPECT_TRUE(back.damage.empty()) << "cut at " << cut << ": " << back.damage[0];
    // At the instant the file was so long, the newest message had this number:
    std::uint64_t newest = 0;
    for (const auto& [size, number] : ends)
      if (size <= cut) newest = number;
    EXPECT_LE(newest + 1 - back.messages.size(), 500u) << "cut at " << cut;
  }
}

TEST_F(McapReaderTest, BytesOfAnyKindAreRefusedOrToldButNeverCrash) {
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole_.substr(0, 1500 + below(8000));
    if (i % 2 == 0) bytes += whole_.substr(whole_.size() - 2000);
    for (std::size_t k = 1 + below(8); k > 0; --k) {
      const std::size_t at = below(bytes.size());
      switch (below(4)) {
        case 0:
          bytes[at] = static_cast<char>(below(256));
          break;
        case 1:  // a length, or part of one
          for (std::size_t j = at; j < std::min(at + 8, bytes.size()); ++j)
            bytes[j] = static_cast<char>(below(2) * 255);
          break;
        case 2:
          bytes.erase(at, 1 + below(20));
          break;
        default:
          bytes.insert(at, bytes.substr(below(bytes.size()), below(50)));
      }
    }
    EXPECT_FALSE(read(bytes).sound()) << "seed 20, file " << i;
  }
}

// A record of `op` with a head of its own making.
std::string record(mcap::Op op, const std::string& content) {
  std::string out;
  mcap::put_record(out, op, [&] { out += content; });
  return out;
}

TEST_F(McapReaderTest, AChunkThatUnpacksToMoreThanItSaysIsRefused) {
  const std::string opening = whole_.substr(0, whole_.find("note.txt") - 25);
  for (const std::uint64_t says : {std::uint64_t{10}, McapReader::kLargestRecord + 1}) {
    std::string chunk, packed = whole_.substr(whole_.find("\x28\xb5\x2f\xfd"), 5000);
    mcap::put(chunk, std::uint64_t{0}), mcap::put(chunk, std::uint64_t{0});
    mcap::put(chunk, says), mcap::put(chunk, std::uint32_t{0});
    mcap::put_text(chunk, "zstd"), mcap::put_text<std::uint64_t>(chunk, packed);
    const ReadBack back =
        read(std::string(mcap::kMagic) + record(mcap::Op::header, std::string(8, '\0')) +
             record(mcap::Op::chunk, chunk));
    EXPECT_EQ(back.damaged_chunks, 1u) << says;
  }
}

TEST_F(McapReaderTest, WhatIsNoRecordingIsRefusedByName) {
  EXPECT_EQ(refusal([] { McapReader("/nowhere.mcap"); }),
            "/nowhere.mcap cannot be opened: give a recording that exists");
  EXPECT_NE(refusal([] { McapReader("/"); }), "");
  const TemporaryFile text("scene {}", ".mcap");
  EXPECT_EQ(refusal([&] { McapReader(text.path()); }),
            text.path() + " is no MCAP file: its first bytes are others");
}

}  // namespace
}  // namespace farhand
