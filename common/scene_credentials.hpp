// What a scene's link names for the two sides to prove who they are. Files are relative to the
// scene.
#pragma once

#include <filesystem>
#include <optional>

#include "common/credentials.hpp"
#include "common/scene.hpp"

namespace farhand {

// Named at all, and so all that is said is encrypted and authenticated.
inline bool has_credentials(const proto::Link& link) {
  return link.has_key_file() || link.has_certificates();
}

std::filesystem::path key_path(const Scene& scene);
CertificateFiles certificate_files(const Scene& scene);

// Read from those files, if any is named. Throws as load_key and load_certificates do.
std::optional<Credentials> link_credentials(const Scene& scene, DtlsRole role);

}  // namespace farhand
