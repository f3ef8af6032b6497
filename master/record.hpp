// The master's ticks in a recording: /master at every tick, /handle/pose and the transform M to H
// for viewers. What a replay needs comes back bit for bit.
#pragma once

#include <vector>

#include "common/recording_file.hpp"
#include "master/loop.hpp"
#include "proto/record.pb.h"

namespace farhand {

class McapReader;

inline constexpr const char* kMasterTopic = "/master";

// What a master has that its ticks do not tell.
struct RecordedMaster {
  int motors = 6;        // angles of the handle
  bool coupled = false;  // to the robot's pose, by the bilateral architecture
  bool aligns = false;   // the handle to the robot's orientation
};

// Fills an empty message.
void fill(record::MasterRecord& to, const MasterRecord& from, const RecordedMaster& master);

// As read from the device; not ok if the message holds another number of angles than a handle has.
HandleReading handle_reading(const record::MasterRecord& from) noexcept;

// Every reading of a recording, in order. Throws a sentence if there is none.
std::vector<HandleReading> read_readings(McapReader& reader);

class MasterRecording {
 public:
  // Adds its channels; the file is borrowed.
  MasterRecording(RecordingFile& file, const proto::Scene& scene);
  void add(const MasterRecord& record);

 private:
  RecordingFile& file_;
  RecordedMaster master_;
  std::uint16_t ticks_, pose_, transforms_;
  ViewerRate viewers_;
  record::MasterRecord message_;
};

}  // namespace farhand
