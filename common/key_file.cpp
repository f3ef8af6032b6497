#include "common/key_file.hpp"

#include <openssl/evp.h>
#include <sys/random.h>

#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/secret_file.hpp"

namespace farhand {
namespace {

std::string digits_of(const std::array<std::byte, kKeyBytes>& secret) {
  return hexadecimal(reinterpret_cast<const unsigned char*>(secret.data()), secret.size());
}

std::optional<std::array<std::byte, kKeyBytes>> from_hexadecimal(const std::string& text) {
  constexpr const char* kDigits = "0123456789abcdef";
  if (text.size() != 2 * kKeyBytes) return {};
  std::array<std::byte, kKeyBytes> out{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char* digit = text[i] == '\0' ? nullptr : std::strchr(kDigits, text[i]);
    if (digit == nullptr) return {};
    out[i / 2] = (out[i / 2] << 4) | static_cast<std::byte>(digit - kDigits);
  }
  return out;
}

}  // namespace

Key make_key(const std::array<std::byte, kKeyBytes>& secret) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  if (EVP_Digest(secret.data(), secret.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("OpenSSL has no SHA-256: install an unrestricted libssl3");
  return {secret, hexadecimal(digest.data(), 4)};
}

Key load_key(const std::filesystem::path& path) {
  const SecretFile file{"key file", path};
  std::istringstream lines(read_secret(
      file,
      {.open_remedy = "run chmod 600 on it, and make a new key if they may have read it",
       .missing_remedy = "make one with farhand-keygen on one machine and copy it to the other"}));
  std::optional<std::array<std::byte, kKeyBytes>> secret;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto here = from_hexadecimal(line);
    if (!here || secret)
      refuse(file, "is not one line of 64 hexadecimal digits",
             "copy it again, whole and unchanged");
    secret = here;
  }
  if (!secret) refuse(file, "holds no key", "copy it again, whole and unchanged");
  return make_key(*secret);
}

Key write_new_key(const std::filesystem::path& path) {
  const SecretFile file{"key file", path};
  std::array<std::byte, kKeyBytes> secret{};
  if (getrandom(secret.data(), secret.size(), 0) != static_cast<ssize_t>(secret.size()))
    refuse(file, "cannot be made without the system's random numbers", "try another machine");
  Key key = make_key(secret);
  write_new_secret(file, "# Farhand key " + key.name +
                             ". Whoever has it can move the robot: keep it secret.\n" +
                             digits_of(secret) + "\n");
  return key;
}

}  // namespace farhand
