// A recording as the hand of a virtual run: its readings come back in order, one a sample. What was
// recorded by the loopback itself gives the same bits again; what a real master recorded meets a
// simulated slave.
#pragma once

#include <map>
#include <string>

#include "common/recording_file.hpp"
#include "tests/loop/loopback.hpp"

namespace farhand {

// The scene to run, from the file `scene` or, if that is empty, as attached to the recording; the
// recording's seed and length go into `options` unless they are already given. Throws a sentence if
// there is nothing to replay; warns of damage.
Scene prepare_replay(const std::string& recording, const std::string& scene,
                     LoopbackOptions& options);

// With what prepare_replay needs to know of this run.
RecordingAbout about_loopback(const Scene& scene, const LoopbackOptions& options,
                              std::map<std::string, std::string> extra);

}  // namespace farhand
