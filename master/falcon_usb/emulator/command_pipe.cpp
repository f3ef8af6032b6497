#include "master/falcon_usb/emulator/command_pipe.hpp"

#include <unistd.h>

#include <array>

namespace farhand::falcon_usb {

std::optional<std::string> CommandPipe::line() {
  std::array<char, 256> bytes;
  const ssize_t count = read(pipe_.file(), bytes.data(), bytes.size());
  if (count > 0) text_.append(bytes.data(), static_cast<std::size_t>(count));
  const std::size_t end = text_.find('\n');
  if (end == std::string::npos) return {};
  std::string out = text_.substr(0, end);
  text_.erase(0, end + 1);
  return out;
}

}  // namespace farhand::falcon_usb
