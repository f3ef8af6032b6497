// A named pipe of this process' own: made, open both ways so that nobody waits and it never ends,
// and removed at the end. One that is there already is taken.
#pragma once

#include <string>

namespace farhand::falcon_usb {

class NamedPipe {
 public:
  // Throws a sentence if it cannot be made, or if something else has that name.
  explicit NamedPipe(std::string path);
  ~NamedPipe();
  NamedPipe(const NamedPipe&) = delete;
  NamedPipe& operator=(const NamedPipe&) = delete;

  int file() const noexcept { return file_; }  // does not block

 private:
  std::string path_;
  int file_ = -1;
};

}  // namespace farhand::falcon_usb
