// What both sides' ticks were given in a virtual run, to give it to them again: for counting and
// timing the ticks alone, without link, device and plant.
#pragma once

#include <vector>

#include "common/scene.hpp"
#include "master/master.hpp"
#include "slave/slave.hpp"

namespace farhand {

struct MasterInput {
  TimePoint now;
  HandleReading reading;
  SlaveToMaster in;
};
struct SlaveInput {
  TimePoint now;
  MasterToSlave in;
  RobotReading robot;
};

struct RecordedTicks {
  std::vector<MasterInput> master;  // from the first answer on
  std::vector<SlaveInput> slave;
};

// Runs the scene until the master has done `ticks` ticks, or to its end.
RecordedTicks record_ticks(const Scene& scene, std::size_t ticks);

// The partner as seen when its message has just arrived.
template <typename Message>
Peer<Message> fresh(const Message& message) {
  return {.newest = &message, .connected = true, .age = Duration(0), .synced = true};
}

}  // namespace farhand
