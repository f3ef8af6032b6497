#include "common/status_line.hpp"

#include <unistd.h>

#include <cstdio>

namespace farhand {

StatusLine::StatusLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDOUT_FILENO) == 1) {}

bool StatusLine::due(TimePoint now) noexcept {
  if (quiet_ || now < next_) return false;
  next_ = now + std::chrono::seconds(1);
  return true;
}

void StatusLine::show(const std::string& line) {
  std::printf(terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stdout);
  shown_ = true;
}

void StatusLine::end() {
  if (shown_ && terminal_) std::printf("\n");
  shown_ = false;
}

}  // namespace farhand
