#include "tests/loop/replay.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/mcap_reader.hpp"
#include "proto/record.pb.h"
#include "tests/loop/run.hpp"
#include "tests/support/scene_edits.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

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

template <typename Record, typename Each>
void for_each(const std::string& path, const char* topic, const Each& each) {
  McapReader reader(path);
  Record tick;
  for (McapReader::Message m; reader.next(m);) {
    if (m.topic != topic) continue;
    EXPECT_TRUE(tick.ParseFromArray(m.data.data(), static_cast<int>(m.data.size())));
    each(tick);
  }
  EXPECT_TRUE(reader.complete());
}

// Bits of the robot's joints, tick by tick.
std::vector<double> joints(const std::string& path) {
  std::vector<double> out;
  for_each<record::SlaveRecord>(path, "/slave", [&](const record::SlaveRecord& tick) {
    out.insert(out.end(), tick.q_rad().begin(), tick.q_rad().end());
  });
  return out;
}

// Architectures that couple the handle to the robot's pose, alone and beside the contact force.
Scene coupled_scene(bool contact) {
  Scene scene = shipped("twin_delta_closed");
  auto& b = *scene.proto.mutable_bilateral();
  if (contact) {
    b.mutable_force_force();
  } else {
    b.mutable_position_position();
    scene.proto.mutable_slave()->clear_force_sensing();
    scene.proto.mutable_slave()->mutable_sim_arm()->clear_force_sensor();
  }
  return scene;
}

TEST(Replay, SameReadingsGiveTheSameBits) {
  for (const char* name :
       {"full", "falcon_arm", "falcon_ahrs", "twin_delta_contact", "falcon_f1"}) {
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

// A recording can only be replayed from its own scene's text, so the same scene runs twice here.
TEST(Replay, WhatABilateralSceneRecordsChangesNoBit) {
  for (const bool contact : {false, true}) {
    const TemporaryFile file("", ".mcap");
    const Scene scene = coupled_scene(contact);
    const LoopbackOptions options{.seed = 7, .duration_s = 4};
    EXPECT_EQ(recorded(scene, options, file.path()).digest, run_scene(scene, options).digest);
    double largest = 0, unlike = 0;
    for_each<record::MasterRecord>(file.path(), "/master", [&](const record::MasterRecord& r) {
      ASSERT_EQ(r.coupling_force_g_n_size(), 3);
      ASSERT_EQ(r.coupling_torque_g_nm_size(), 3);
      for (int i = 0; i < 3; ++i) {
        const double f = r.coupling_force_g_n(i);
        largest = std::max(largest, std::abs(f));
        unlike = std::max(unlike, std::abs(f - r.environment_force_g_n(i)));
      }
    });
    EXPECT_GT(largest, 0.5);
    // With positions alone the coupling is all there is; the contact comes on top.
    EXPECT_EQ(unlike > 0, contact);
  }
}

TEST(Replay, TheBoundarysShareIsRecordedWhereThereIsABoundary) {
  for (const char* name : {"twin_delta_guided", "twin_delta_contact"}) {
    const TemporaryFile file("", ".mcap");
    const Scene scene = shipped(name);
    recorded(scene, {}, file.path());
    const bool has = scene.proto.slave().has_boundary();
    const double cap = scene.proto.slave().boundary().max_force_newton();
    double largest = 0;
    for_each<record::SlaveRecord>(file.path(), "/slave", [&](const record::SlaveRecord& r) {
      ASSERT_EQ(r.boundary_force_s_n_size(), has ? 3 : 0);
      ASSERT_EQ(r.boundary_torque_s_nm_size(), has ? 3 : 0);
      if (!has) return;
      const Vec3 f(r.boundary_force_s_n(0), r.boundary_force_s_n(1), r.boundary_force_s_n(2));
      largest = std::max(largest, f.norm());
    });
    for_each<record::MasterRecord>(file.path(), "/master", [](const record::MasterRecord& r) {
      ASSERT_EQ(r.coupling_force_g_n_size(), 0);
    });
    std::printf("%s: the boundary's force is at most %.2f N\n", name, largest);
    EXPECT_EQ(largest > 1, has);
    EXPECT_LE(largest, cap * (1 + 1e-4));
  }
}

TEST(Replay, AnAhrsIsRecordedWhereThereIsOne) {
  for (const char* name : {"falcon_ahrs", "falcon_arm"}) {
    SCOPED_TRACE(name);
    const TemporaryFile file("", ".mcap");
    const Scene scene = shipped(name);
    recorded(scene, {.duration_s = 3}, file.path());
    const bool has = scene.proto.master().has_ahrs();
    int samples = 0, whole = 0, ok = 0;
    for_each<record::MasterRecord>(file.path(), "/master", [&](const record::MasterRecord& r) {
      samples += r.ahrs_angular_rate_i_rad_per_s_size() > 0;
      whole += r.ahrs_specific_force_i_m_per_s2_size() == 3 &&
               r.ahrs_magnetic_field_i_t_size() == 3 && r.has_ahrs_time_ns();
      ok += r.ahrs_state() == record::AHRS_OK && r.ahrs_yaw_sigma_rad() > 0;
      ASSERT_EQ(r.has_ahrs_yaw_sigma_rad(), has);
      ASSERT_EQ(r.has_ahrs_tilt_sigma_rad(), has);
    });
    EXPECT_NEAR(samples, has ? 3 * scene.proto.master().ahrs().rate_hz() : 0, 2);
    EXPECT_EQ(whole, samples);
    EXPECT_NEAR(ok, has ? 2000 : 0, 10);  // all but the first second
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
