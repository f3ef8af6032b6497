// What a side of the link proves itself by: the key that both share, or a certificate of its own.
#pragma once

#include <string>
#include <variant>

#include "common/certificates.hpp"
#include "common/key_file.hpp"

namespace farhand {

using Credentials = std::variant<Key, Certificates>;

// "key 01234567" or "certificate 01234567 of authority 89abcdef".
inline std::string to_string(const Credentials& c) {
  const auto* key = std::get_if<Key>(&c);
  return key != nullptr ? "key " + key->name : "certificate " + std::get<Certificates>(c).name;
}

}  // namespace farhand
