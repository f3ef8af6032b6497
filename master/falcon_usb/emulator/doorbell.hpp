// A device file as poll() sees it: ready when something of it is finished, and else not. It is a
// named pipe, full of bytes that nobody is meant to read while there is nothing, and empty when
// there is: poll() says of an empty one that it can be written to, which is how the kernel's USB
// tells of a finished transfer, too.
#pragma once

#include "master/falcon_usb/emulator/named_pipe.hpp"

namespace farhand::falcon_usb {

class Doorbell {
 public:
  // In quiet. Throws a sentence if the file cannot be made.
  explicit Doorbell(const std::string& path);

  // Both may be called again and again.
  void ring() noexcept;
  void quiet() noexcept;

 private:
  NamedPipe pipe_;
  bool rings_ = true;
};

}  // namespace farhand::falcon_usb
