// The writer against the reader: what was written comes back, a full disk costs counted messages
// and nothing else. (Against another reader: tests/mcap.)
#include "common/mcap_writer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "tests/support/mcap_files.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

TEST(McapWriter, WhatIsWrittenComesBackInOrder) {
  const TemporaryFile file("", ".mcap");
  write_example(file.path(), 2000);
  const ReadBack back = read_back(file.path());
  EXPECT_TRUE(back.complete);
  EXPECT_EQ(back.damage, std::vector<std::string>{});
  EXPECT_EQ(back.metadata.at("about").at("role"), "test");
  EXPECT_EQ(back.attachments.at("note.txt"), "as it was");
  ASSERT_EQ(back.messages.size(), 3000u);
  std::size_t k = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    EXPECT_EQ(back.messages[k++], example_message(i, "/fast"));
    if (i % 2 == 1) continue;
    EXPECT_EQ(back.messages[k++], example_message(i, "/slow"));
  }
}

TEST(McapWriter, SameMessagesGiveTheSameBytes) {
  const TemporaryFile a("", ".mcap"), b("", ".mcap");
  write_example(a.path(), 700);
  write_example(b.path(), 700);
  EXPECT_EQ(bytes_of(a.path()), bytes_of(b.path()));
}

TEST(McapWriter, AFileWithoutMessagesIsWhole) {
  const TemporaryFile file("", ".mcap");
  write_example(file.path(), 0);
  const ReadBack back = read_back(file.path());
  EXPECT_TRUE(back.complete);
  EXPECT_EQ(back.damage, std::vector<std::string>{});
  EXPECT_TRUE(back.messages.empty());
}

TEST(McapWriter, AClosedChunkIsInTheFileBeforeTheWriterEnds) {
  const TemporaryFile file("", ".mcap");
  McapWriter writer(file.path(), "test");
  const auto channel = writer.add_channel("/a", 0, "text");
  const std::uint64_t span = McapWriter::kChunkSpan.count();
  writer.write(channel, 0, "first");
  EXPECT_EQ(bytes_of(file.path()), "");
  writer.write(channel, span, "second");
  const ReadBack back = read_back(file.path());
  EXPECT_FALSE(back.complete);
  EXPECT_EQ(back.damage, std::vector<std::string>{});
  ASSERT_EQ(back.messages.size(), 1u);
  EXPECT_EQ(back.messages[0].data, "first");

  const auto before = std::filesystem::file_size(file.path());
  writer.write(channel, span, std::string(McapWriter::kChunkBytes, 'x'));
  EXPECT_GT(std::filesystem::file_size(file.path()), before) << "closed by size";
}

TEST(McapWriter, WhatCannotBeOpenedIsRefusedByName) {
  const auto why = refusal([] { McapWriter("/nowhere/run.mcap", "test"); });
  EXPECT_TRUE(why.starts_with("/nowhere/run.mcap")) << why;
}

TEST(McapWriter, ADeviceThatIsAlwaysFullLosesAllAndSaysWhy) {
  McapWriter writer("/dev/full", "test");
  const auto channel = writer.add_channel("/a", 0, "text");
  for (std::uint64_t i = 0; i < 1000; ++i) writer.write(channel, i * 1'000'000, "message");
  writer.close();
  EXPECT_EQ(writer.lost(), 1000u);
  EXPECT_EQ(writer.error(), "No space left on device");
}

// The limit on the size of a file stands for a full disk: write() stores a part, then nothing.
class FullDisk : public ::testing::Test {
 protected:
  FullDisk() {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
  }
  ~FullDisk() override { limit(before_.rlim_cur); }
  void limit(rlim_t bytes) const {
    const rlimit now{bytes, before_.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &now), 0);
  }
  rlimit before_{};
};

TEST_F(FullDisk, KeepsWhatWasThereAndCountsTheRest) {
  const TemporaryFile file("", ".mcap");
  limit(60'000);
  const std::uint64_t lost = write_example(file.path(), 20'000);
  const ReadBack back = read_back(file.path());
  EXPECT_EQ(back.damage, std::vector<std::string>{});
  EXPECT_GT(back.messages.size(), 500u);
  EXPECT_EQ(back.messages.size() + lost, 30'000u);
  EXPECT_EQ(back.messages[0], example_message(0, "/fast"));
}

TEST_F(FullDisk, RecordingGoesOnWhenThereIsRoomAgain) {
  const TemporaryFile file("", ".mcap");
  McapWriter writer(file.path(), "test");
  const auto channel = writer.add_channel("/a", 0, "text");
  std::uint64_t t = 0;
  const auto write = [&](int count) {
    for (int i = 0; i < count; ++i, ++t) writer.write(channel, t * 1'000'000, noise(t, 100));
  };
  write(1000);
  limit(writer.file_bytes() + 1000);
  write(1000);
  EXPECT_GE(writer.lost(), 500u);
  EXPECT_EQ(writer.error(), "File too large");
  limit(before_.rlim_cur);
  write(1000);
  writer.close();
  const ReadBack back = read_back(file.path());
  EXPECT_TRUE(back.complete);
  EXPECT_EQ(back.damage, std::vector<std::string>{});
  EXPECT_EQ(back.messages.size() + writer.lost(), 3000u);
  EXPECT_EQ(back.messages.back().log_time_ns, 2999u * 1'000'000);
}

}  // namespace
}  // namespace farhand
