// A scene's link, and its network: what the two impairments mean to the library, and how they read
// in a plan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/impairment.hpp"
#include "common/link.hpp"
#include "common/scene.hpp"

namespace farhand {

// What both ends of the scene's link have alike.
LinkConfig link_config(const Scene& scene, std::uint64_t session, SecureChannel* secure = nullptr);

ImpairmentConfig impairment_config(const proto::Impairment& impairment);

// Nothing for a way that the link leaves out.
std::optional<ImpairmentConfig> to_slave_config(const proto::Link& link);
std::optional<ImpairmentConfig> to_master_config(const proto::Link& link);

// A line for each way, such as "to_slave          delay 1 ms, gamma jitter 0.2 ms, loss 1 %".
std::vector<std::string> network_stages(const proto::Link& link);

}  // namespace farhand
