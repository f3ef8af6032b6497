// The slave's ticks in a recording: /slave at every tick; for viewers /robot/pose, /robot/target
// and the transforms S to E and S to M.
#pragma once

#include "common/recording_file.hpp"
#include "proto/record.pb.h"
#include "slave/loop.hpp"

namespace farhand {

inline constexpr const char* kSlaveTopic = "/slave";
// Metadata: q_lower_rad, q_upper_rad, joint_torque_nm; of all joints, with spaces between.
inline constexpr const char* kRobotMetadata = "robot";

// Fills an empty message with what a slave of this configuration did.
void fill(record::SlaveRecord& to, const SlaveRecord& from, const SlaveConfig& slave);

class SlaveRecording {
 public:
  // Adds its channels, and the robot's limits as metadata; the file is borrowed.
  SlaveRecording(RecordingFile& file, const SlaveConfig& slave);
  void add(const SlaveRecord& record);

 private:
  RecordingFile& file_;
  SlaveConfig slave_;
  std::uint16_t ticks_, pose_, target_, transforms_;
  ViewerRate viewers_;
  record::SlaveRecord message_;
};

}  // namespace farhand
