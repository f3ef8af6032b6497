// What can be said of a serial line without opening it: some devices restart when it is opened.
#pragma once

#include <string>

#include "common/doctor.hpp"
#include "common/scene.hpp"

namespace farhand {

// "cannot be read (why); what to do about it", for an errno that opening the path gave or would.
std::string unreadable_line(const std::string& path, int error);

// The same by asking the system, with the path in front; empty if this process may read it.
std::string line_fault(const std::string& path);

// The doctor on the serial line of a scene's AHRS; nothing without one.
doctor::Findings examine_ahrs(const Scene& scene);

}  // namespace farhand
