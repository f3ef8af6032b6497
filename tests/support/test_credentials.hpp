// What the two sides of a test's link prove themselves by, of either kind.
#pragma once

#include <array>
#include <map>

#include "common/certificate_issue.hpp"
#include "common/credentials.hpp"
#include "common/random.hpp"

namespace farhand {

enum class Proof { key, certificates };

struct SideCredentials {
  Credentials client, server;
};

inline Key test_key(std::uint64_t seed) {
  Random random(seed);
  std::array<std::byte, kKeyBytes> secret{};
  for (std::byte& b : secret) b = static_cast<std::byte>(random.bits());
  return make_key(secret);
}

// All of one name.
inline const Issued& test_authority(std::uint64_t seed) {
  static std::map<std::uint64_t, Issued> made;
  const auto found = made.find(seed);
  return found != made.end() ? found->second : made[seed] = make_authority("test authority");
}

inline Certificates test_certificates(std::uint64_t seed, const Request& request) {
  const Issued own = issue(test_authority(seed), request);
  return make_certificates(test_authority(seed).certificate, own.certificate, own.private_key);
}

inline Certificates test_certificates(std::uint64_t seed, DtlsRole role) {
  return test_certificates(seed, {.name = "test side", .usage = usage_of(role)});
}

// Of one key, or one authority, for each seed.
inline SideCredentials test_credentials(Proof proof, std::uint64_t seed) {
  if (proof == Proof::key) return {test_key(seed), test_key(seed)};
  return {test_certificates(seed, DtlsRole::client), test_certificates(seed, DtlsRole::server)};
}

}  // namespace farhand
