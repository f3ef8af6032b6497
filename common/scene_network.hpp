// A scene's network: what its two impairments mean to the library, and how they read in a plan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/impairment.hpp"
#include "proto/scene.pb.h"

namespace farhand {

ImpairmentConfig impairment_config(const proto::Impairment& impairment);

// Nothing for a way that the link leaves out.
std::optional<ImpairmentConfig> to_slave_config(const proto::Link& link);
std::optional<ImpairmentConfig> to_master_config(const proto::Link& link);

// A line for each way, such as "to_slave          delay 1 ms, gamma jitter 0.2 ms, loss 1 %".
std::vector<std::string> network_stages(const proto::Link& link);

}  // namespace farhand
