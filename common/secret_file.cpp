#include "common/secret_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace farhand {
namespace {

constexpr std::size_t kMaxFileBytes = 16384;

struct OpenFile {
  explicit OpenFile(int descriptor) : fd(descriptor) {}
  ~OpenFile() {
    if (fd >= 0) close(fd);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int fd;
};

std::string with_reason(const char* what) {
  return std::string(what) + " (" + std::strerror(errno) + ")";
}

}  // namespace

void refuse(const SecretFile& file, const std::string& what, const std::string& remedy) {
  throw std::runtime_error(file.kind + " " + file.path.string() + " " + what + ": " + remedy);
}

std::string read_secret(const SecretFile& file, const SecretFileRules& rules) {
  const OpenFile from(::open(file.path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (from.fd < 0 || fstat(from.fd, &status) != 0)
    refuse(file, with_reason("cannot be opened"), rules.missing_remedy);
  if (status.st_uid != geteuid() && status.st_uid != 0)
    refuse(file, "belongs to another user than root and the one that runs this",
           "run chown on it after a look at what it holds");
  if ((status.st_mode & rules.forbidden) != 0) refuse(file, rules.open, rules.open_remedy);
  std::string text(kMaxFileBytes, '\0');
  const ssize_t size = read(from.fd, text.data(), text.size());
  if (size < 0) refuse(file, with_reason("cannot be read"), "name a file made by farhand-keygen");
  if (static_cast<std::size_t>(size) == text.size())
    refuse(file, "is longer than 16 KiB", "name a file made by farhand-keygen");
  text.resize(static_cast<std::size_t>(size));
  return text;
}

void write_new_secret(const SecretFile& file, const std::string& text, mode_t mode) {
  const OpenFile to(::open(file.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  if (to.fd < 0 && errno == EEXIST)
    refuse(file, "exists", "name a new one; what is in use is never overwritten");
  if (to.fd < 0)
    refuse(file, with_reason("cannot be made"), "name a place in a directory you may write");
  if (write(to.fd, text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      fsync(to.fd) != 0) {
    const std::string what = with_reason("cannot be written");
    unlink(file.path.c_str());
    refuse(file, what, "make room on the disk and try again");
  }
}

std::string hexadecimal(const unsigned char* bytes, std::size_t size) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string out;
  for (std::size_t i = 0; i < size; ++i) {
    out += kDigits[bytes[i] >> 4];
    out += kDigits[bytes[i] & 15];
  }
  return out;
}

}  // namespace farhand
