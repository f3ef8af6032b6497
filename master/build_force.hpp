// The force feedback's part of a scene; see build.hpp.
#pragma once

#include <string>
#include <vector>

#include "master/master.hpp"
#include "proto/scene.pb.h"

namespace farhand {

// Of a master with force_feedback. Ts: period of the tick [s].
ForceFeedbackConfig force_feedback_config(const proto::Master& master, double Ts);

// One line per stage, in the order of the tick.
std::vector<std::string> force_stages(const proto::Master& master);

}  // namespace farhand
