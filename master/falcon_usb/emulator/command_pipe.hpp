// Lines that somebody writes into a named pipe, from a shell by echo, say.
#pragma once

#include <optional>
#include <string>

#include "master/falcon_usb/emulator/named_pipe.hpp"

namespace farhand::falcon_usb {

class CommandPipe {
 public:
  explicit CommandPipe(std::string path) : pipe_(std::move(path)) {}

  // The next whole line, or nothing if there is none yet.
  std::optional<std::string> line();

 private:
  NamedPipe pipe_;
  std::string text_;  // read and not given yet
};

}  // namespace farhand::falcon_usb
