// The live line of a running program: once a second, or more often, overwritten in place on a
// terminal; a line of its own elsewhere, never more often.
#pragma once

#include <string>

#include "common/time.hpp"

namespace farhand {

class StatusLine {
 public:
  explicit StatusLine(bool quiet);
  // True once a second of loop time: the moment to build a line and show() it. `often`: five times
  // a second on a terminal, for what a person acts upon as it changes.
  bool due(TimePoint now, bool often = false) noexcept;
  void show(const std::string& line);
  // Puts the cursor below the line.
  void end();

 private:
  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  TimePoint next_{};
};

}  // namespace farhand
