// What a parsed scene is held against. Both give the first fault, or nothing.
#pragma once

#include <optional>

#include "common/scene_words.hpp"
#include "proto/scene.pb.h"

namespace farhand {

// Field by field, from their options in proto/: finite, within [min, max], exactly `length` or
// `at_most` values, and `needed` there. In the order of the schema.
std::optional<SceneFault> check_fields(const proto::Scene& scene);

// How the parts fit together: the tables of scene_rules.hpp.
std::optional<SceneFault> check_rules(const proto::Scene& scene);

}  // namespace farhand
