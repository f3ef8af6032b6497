// What a compensation at the handle is given each tick, whichever method it is.
#pragma once

#include "common/wire.hpp"
#include "master/handle.hpp"

namespace farhand {

struct CouplingInputs {
  const HandlePose& handle;
  const Twist& V_MH;           // of H relative to M, at H, M axes
  const SlaveToMaster& robot;  // the newest message
  Duration echo_age;           // of our own message that it answers
  double share = 1;            // of what may be felt, by the message's age; it comes back in slowly
  TimePoint now{};             // when the handle was read
};

}  // namespace farhand
