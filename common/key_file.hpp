// The secret that both sides of a link share, and the file it lives in: comment lines and one line
// of 64 hexadecimal digits.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>

namespace farhand {

inline constexpr std::size_t kKeyBytes = 32;

struct Key {
  std::array<std::byte, kKeyBytes> secret{};
  // Tells keys apart and may be shown: the first 8 hexadecimal digits of the secret's SHA-256.
  std::string name;
};

// Throws a sentence naming the file and the remedy: it is missing, others than its owner may read
// or change it, or it is not such a file.
Key load_key(const std::filesystem::path& path);

// A new random key in a new file that only its owner may read. Throws such a sentence if the file
// exists or cannot be written.
Key write_new_key(const std::filesystem::path& path);

// The key with this secret.
Key make_key(const std::array<std::byte, kKeyBytes>& secret);

}  // namespace farhand
