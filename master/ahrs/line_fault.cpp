#include "master/ahrs/line_fault.hpp"

#include <grp.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace farhand {
namespace {

std::string owning_group(const std::string& path) {
  struct stat what {};
  const group* owner = stat(path.c_str(), &what) == 0 ? getgrgid(what.st_gid) : nullptr;
  return owner != nullptr ? owner->gr_name : "dialout";
}

std::string remedy(const std::string& path, int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "plug the AHRS in, or give the path that it has: ls /dev/serial/by-id";
    case EACCES:
    case EPERM:
      return "let this user read it: sudo usermod -aG " + owning_group(path) +
             " \"$USER\", then log in again";
    case EBUSY:
      return "another program has it: stop that one";
    default:
      return "give the path of a serial line such as /dev/ttyUSB0";
  }
}

}  // namespace

std::string unreadable_line(const std::string& path, int error) {
  return std::string("cannot be read (") + std::strerror(error) + "); " + remedy(path, error);
}

std::string line_fault(const std::string& path) {
  struct stat what {};
  int error = stat(path.c_str(), &what) != 0 ? errno : 0;
  if (error == 0 && !S_ISCHR(what.st_mode)) error = ENOTTY;
  if (error == 0 && access(path.c_str(), R_OK) != 0) error = errno;
  return error == 0 ? std::string() : path + " " + unreadable_line(path, error);
}

doctor::Findings examine_ahrs(const Scene& scene) {
  using doctor::Level;
  if (!scene.proto.master().ahrs().has_serial()) return {};
  const auto& line = scene.proto.master().ahrs().serial();
  const std::string fault = line_fault(line.path());
  if (!fault.empty()) return {{Level::problem, "ahrs", fault}};
  return {{Level::ok, "ahrs", fmt::format("{} may be read, at {} baud", line.path(), line.baud())}};
}

}  // namespace farhand
