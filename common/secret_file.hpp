// Small text files that a side proves itself by: read only if nobody else could have read or
// changed what he must not, written once and never over another. What is wrong is thrown as a
// sentence that names the file and the remedy.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>

namespace farhand {

struct SecretFile {
  std::string kind;  // "key file"
  std::filesystem::path path;
};

[[noreturn]] void refuse(const SecretFile& file, const std::string& what,
                         const std::string& remedy);

// What group and others must not be able to do; the sentence where they can.
struct SecretFileRules {
  mode_t forbidden = 0077;
  std::string open = "is open to other users of this machine";
  std::string open_remedy;
  std::string missing_remedy;
};

// All of it. Refused is also what belongs to somebody else, but for root, and what is 16 KiB or
// longer.
std::string read_secret(const SecretFile& file, const SecretFileRules& rules);

// In a new file of this mode; none if it cannot be written whole.
void write_new_secret(const SecretFile& file, const std::string& text, mode_t mode = 0600);

// Two digits a byte, lower case.
std::string hexadecimal(const unsigned char* bytes, std::size_t size);

}  // namespace farhand
