#include "common/key_file.hpp"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>

namespace farhand {
namespace {

constexpr std::size_t kMaxFileBytes = 4096;
constexpr const char* kDigits = "0123456789abcdef";

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what,
                         const std::string& remedy) {
  throw std::runtime_error("key file " + path.string() + " " + what + ": " + remedy);
}

struct File {
  explicit File(int descriptor) : fd(descriptor) {}
  ~File() {
    if (fd >= 0) close(fd);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int fd;
};

std::string hexadecimal(std::span<const std::byte> bytes) {
  std::string out;
  for (const std::byte b : bytes) {
    out += kDigits[std::to_integer<unsigned>(b) >> 4];
    out += kDigits[std::to_integer<unsigned>(b) & 15];
  }
  return out;
}

std::optional<std::array<std::byte, kKeyBytes>> from_hexadecimal(const std::string& text) {
  if (text.size() != 2 * kKeyBytes) return {};
  std::array<std::byte, kKeyBytes> out{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char* digit = text[i] == '\0' ? nullptr : std::strchr(kDigits, text[i]);
    if (digit == nullptr) return {};
    out[i / 2] = (out[i / 2] << 4) | static_cast<std::byte>(digit - kDigits);
  }
  return out;
}

std::string contents(const File& file, const std::filesystem::path& path) {
  std::string text(kMaxFileBytes, '\0');
  const ssize_t size = read(file.fd, text.data(), text.size());
  if (size < 0)
    refuse(path, std::string("cannot be read (") + std::strerror(errno) + ")",
           "name a file made by farhand-keygen");
  text.resize(static_cast<std::size_t>(size));
  return text;
}

}  // namespace

Key make_key(const std::array<std::byte, kKeyBytes>& secret) {
  std::array<std::byte, EVP_MAX_MD_SIZE> digest{};
  if (EVP_Digest(secret.data(), secret.size(), reinterpret_cast<unsigned char*>(digest.data()),
                 nullptr, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("OpenSSL has no SHA-256: install an unrestricted libssl3");
  return {secret, hexadecimal(std::span(digest).first(4))};
}

Key load_key(const std::filesystem::path& path) {
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (file.fd < 0 || fstat(file.fd, &status) != 0)
    refuse(path, std::string("cannot be opened (") + std::strerror(errno) + ")",
           "make one with farhand-keygen on one machine and copy it to the other");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    refuse(path, "is open to other users of this machine",
           "run chmod 600 on it, and make a new key if they may have read it");
  std::istringstream lines(contents(file, path));
  std::optional<std::array<std::byte, kKeyBytes>> secret;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto here = from_hexadecimal(line);
    if (!here || secret)
      refuse(path, "is not one line of 64 hexadecimal digits",
             "copy it again, whole and unchanged");
    secret = here;
  }
  if (!secret) refuse(path, "holds no key", "copy it again, whole and unchanged");
  return make_key(*secret);
}

Key write_new_key(const std::filesystem::path& path) {
  std::array<std::byte, kKeyBytes> secret{};
  if (getrandom(secret.data(), secret.size(), 0) != static_cast<ssize_t>(secret.size()))
    refuse(path, "cannot be made without the system's random numbers", "try another machine");
  Key key = make_key(secret);
  const std::string text = "# Farhand key " + key.name +
                           ". Whoever has it can move the robot: keep it secret.\n" +
                           hexadecimal(secret) + "\n";
  const File file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.fd < 0 && errno == EEXIST)
    refuse(path, "exists", "name a new file; a key that is in use is never overwritten");
  if (file.fd < 0)
    refuse(path, std::string("cannot be made (") + std::strerror(errno) + ")",
           "name a file in a directory you may write");
  if (write(file.fd, text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      fsync(file.fd) != 0)
    refuse(path, std::string("cannot be written (") + std::strerror(errno) + ")",
           "remove it, make room on the disk and try again");
  return key;
}

}  // namespace farhand
