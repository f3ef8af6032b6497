#include "tests/loop/replay.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/mcap_reader.hpp"
#include "proto/record.pb.h"
#include "tests/loop/run.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

Scene shipped(const std::string& name) {
  return load_scene(FARHAND_SOURCE_DIR "/deploy/scenes/" + name + ".textproto");
}

RunResult recorded(const Scene& scene, const LoopbackOptions& options, const std::string& path) {
  RecordingFile file(path, scene, about_loopback(scene, options, {}));
  const RunResult result = run_scene(scene, options, &file);
  file.end();
  return result;
}

RunResult replayed(const std::string& path, const std::string& into) {
  LoopbackOptions options;
  const Scene scene = prepare_replay(path, "", options);
  return recorded(scene, options, into);
}

std::string bytes_of(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

// Bits of the robot's joints, tick by tick.
std::vector<double> joints(const std::string& path) {
  std::vector<double> out;
  McapReader reader(path);
  record::SlaveRecord tick;
  for (McapReader::Message m; reader.next(m);) {
    if (m.topic != "/slave") continue;
    EXPECT_TRUE(tick.ParseFromArray(m.data.data(), static_cast<int>(m.data.size())));
    out.insert(out.end(), tick.q_rad().begin(), tick.q_rad().end());
  }
  EXPECT_TRUE(reader.complete());
  return out;
}

TEST(Replay, SameReadingsGiveTheSameBits) {
  for (const char* name : {"full", "falcon_arm", "twin_delta_contact", "falcon_f1"}) {
    SCOPED_TRACE(name);
    const TemporaryFile first("", ".mcap"), second("", ".mcap");
    const Scene scene = shipped(name);
    const RunResult run = recorded(scene, {.seed = 7, .duration_s = 4}, first.path());
    const RunResult again = replayed(first.path(), second.path());
    EXPECT_EQ(again.digest, run.digest);
    EXPECT_EQ(again.master.ticks, 4 * scene.proto.rate_hz());
    EXPECT_EQ(again.slave.coupled_ticks, run.slave.coupled_ticks);
    EXPECT_EQ(joints(second.path()), joints(first.path()));
    EXPECT_EQ(joints(first.path()).size(), 6 * run.slave.ticks);
  }
}

TEST(Replay, RecordingChangesNothingAndGivesTheSameFileAgain) {
  const TemporaryFile first("", ".mcap"), second("", ".mcap");
  const Scene scene = shipped("full");
  const LoopbackOptions options{.seed = 3, .duration_s = 2};
  const RunResult run = recorded(scene, options, first.path());
  EXPECT_EQ(recorded(scene, options, second.path()).digest, run.digest);
  EXPECT_EQ(run_scene(scene, options).digest, run.digest);
  EXPECT_EQ(bytes_of(first.path()), bytes_of(second.path()));
}

TEST(Replay, WhatItCannotReplayIsRefusedInASentence) {
  const TemporaryFile file("", ".mcap");
  LoopbackOptions options;
  const auto why = [&] { return refusal([&] { prepare_replay(file.path(), "", options); }); };
  EXPECT_NE(why().find("is no MCAP file"), std::string::npos);
  McapWriter(file.path(), "test").close();
  EXPECT_NE(why().find("no ticks of a master"), std::string::npos);
}

TEST(Replay, ARecordingNeverOverwritesWhatTheRunReads) {
  const TemporaryFile file("", ".mcap");
  Scene scene = shipped("minimal");
  const RecordingAbout about{.role = "test"};
  EXPECT_EQ(refusal([&] { RecordingFile(file.path(), scene, about, {file.path()}); }),
            file.path() + " is read by this run: give another file to record into");
  scene.path = file.path();
  EXPECT_NE(refusal([&] { RecordingFile(file.path(), scene, about); }), "");
}

TEST(Replay, TenMinutesOfBothSidesTakeAtMost300Megabytes) {
  const TemporaryFile file("", ".mcap");
  recorded(shipped("full"), {.duration_s = 30}, file.path());
  const double megabytes = 20 * static_cast<double>(std::filesystem::file_size(file.path())) * 1e-6;
  std::printf("ten minutes of the fullest scene: %.0f MB\n", megabytes);
  EXPECT_LE(megabytes, 300);
}

}  // namespace
}  // namespace farhand
