// The slave's ticks in a recording: /slave at every tick; for viewers /robot/pose, /robot/target
// and the transforms S to E and S to M.
#pragma once

#include "common/recording_file.hpp"
#include "proto/record.pb.h"
#include "slave/loop.hpp"

namespace farhand {

inline constexpr const char* kSlaveTopic = "/slave";

// Fills an empty message.
void fill(record::SlaveRecord& to, const SlaveRecord& from);

class SlaveRecording {
 public:
  // Adds its channels; the file is borrowed. R_SM turns the handle's axes into the robot's.
  SlaveRecording(RecordingFile& file, const Mat3& R_SM);
  void add(const SlaveRecord& record);

 private:
  RecordingFile& file_;
  Pose X_SM_;
  std::uint16_t ticks_, pose_, target_, transforms_;
  ViewerRate viewers_;
  record::SlaveRecord message_;
};

}  // namespace farhand
