#include "common/status_line.hpp"

#include <unistd.h>

#include <cstdio>

namespace farhand {

StatusLine::StatusLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDOUT_FILENO) == 1) {}

bool StatusLine::due(TimePoint now, bool often) noexcept {
  constexpr Duration kSeldom = std::chrono::seconds(1), kOften = std::chrono::milliseconds(200);
  const Duration early = often && terminal_ ? kSeldom - kOften : Duration::zero();
  if (quiet_ || now < next_ - early) return false;
  next_ = now + kSeldom;
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
