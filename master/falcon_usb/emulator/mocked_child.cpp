#include "master/falcon_usb/emulator/mocked_child.hpp"

#include <dlfcn.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace farhand::falcon_usb {
namespace {

// What this process ignores the command need not.
class Attributes {
 public:
  Attributes() {
    posix_spawnattr_init(&all_);
    sigset_t ignored;
    sigemptyset(&ignored);
    sigaddset(&ignored, SIGPIPE);
    sigaddset(&ignored, SIGXFSZ);
    posix_spawnattr_setsigdefault(&all_, &ignored);
    posix_spawnattr_setflags(&all_, POSIX_SPAWN_SETSIGDEF);
  }
  ~Attributes() { posix_spawnattr_destroy(&all_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  const posix_spawnattr_t* get() const noexcept { return &all_; }

 private:
  posix_spawnattr_t all_;
};

constexpr const char* kLibrary = "libumockdev-preload.so.0";

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> out;
  for (std::string& s : strings) out.push_back(s.data());
  out.push_back(nullptr);
  return out;
}

}  // namespace

void mock_this_process(char** argv) {
  if (dlopen(kLibrary, RTLD_LAZY | RTLD_NOLOAD) != nullptr) return;
  const char* set = std::getenv("LD_PRELOAD");
  const std::string others = set != nullptr ? set : "";
  if (others.find(kLibrary) != std::string::npos)
    throw std::runtime_error(std::string(kLibrary) + " cannot be loaded; install umockdev");
  setenv("LD_PRELOAD", (others.empty() ? kLibrary : kLibrary + (":" + others)).c_str(), 1);
  execv("/proc/self/exe", argv);
  throw std::runtime_error(std::string("this program cannot begin again: ") + std::strerror(errno));
}

MockedChild::MockedChild(const std::vector<std::string>& command) {
  std::vector<std::string> words = command;
  const Attributes attributes;
  const int error = posix_spawnp(&id_, words[0].c_str(), nullptr, attributes.get(),
                                 pointers(words).data(), environ);
  if (error != 0)
    throw std::runtime_error("cannot run '" + words[0] + "': " + std::strerror(error));
}

std::optional<int> MockedChild::status() {
  int status = 0;
  if (waitpid(id_, &status, WNOHANG) != id_) return {};
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

void MockedChild::terminate() const noexcept {
  kill(id_, SIGTERM);
}

}  // namespace farhand::falcon_usb
