#include "master/falcon_usb/emulator/named_pipe.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace farhand::falcon_usb {
namespace {

bool is_pipe(int file) noexcept {
  struct stat s {};
  return fstat(file, &s) == 0 && S_ISFIFO(s.st_mode);
}

}  // namespace

NamedPipe::NamedPipe(std::string path) : path_(std::move(path)) {
  if (mkfifo(path_.c_str(), 0666) == 0 || errno == EEXIST)
    file_ = open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0)
    throw std::runtime_error("the pipe " + path_ + " cannot be made: " + std::strerror(errno));
  if (is_pipe(file_)) return;
  close(file_);
  throw std::runtime_error(path_ + " is there already, and is not a pipe");
}

NamedPipe::~NamedPipe() {
  unlink(path_.c_str());
  close(file_);
}

}  // namespace farhand::falcon_usb
