#include "common/scene_credentials.hpp"

namespace farhand {

std::filesystem::path key_path(const Scene& scene) {
  return beside(scene, scene.proto.link().key_file());
}

CertificateFiles certificate_files(const Scene& scene) {
  const auto& c = scene.proto.link().certificates();
  return {beside(scene, c.authority_file()), beside(scene, c.certificate_file()),
          beside(scene, c.private_key_file())};
}

std::optional<Credentials> link_credentials(const Scene& scene, DtlsRole role) {
  if (scene.proto.link().has_certificates())
    return load_certificates(certificate_files(scene), role);
  if (scene.proto.link().has_key_file()) return load_key(key_path(scene));
  return {};
}

}  // namespace farhand
