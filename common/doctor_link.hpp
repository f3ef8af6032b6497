// The doctor on the scene, its link's addresses, and its key or certificates.
#pragma once

#include <cstddef>
#include <optional>

#include "common/certificates.hpp"
#include "common/doctor.hpp"
#include "common/program.hpp"

namespace farhand::doctor {

// Loads and checks it; `to` has it if it is good.
Finding scene_file(const std::string& path, std::optional<Scene>& to);

// The side's own address is bound for a moment, the master's way to the slave looked up; nothing is
// sent. One finding if the scene, as seen from this side, has no link.
Findings link(const std::string& side, const ProgramOptions& options, const Scene& scene);

// `bytes` of a socket's receive buffer hold the messages of the time after which they are stale.
Finding receive_buffer(std::size_t bytes, const proto::Scene& scene);

// Its key or certificates, as the client (a master) or the server needs them.
Finding credentials(const Scene& scene, DtlsRole role);

}  // namespace farhand::doctor
