// Where everything is in a scene's text, and what is wrong with text that protobuf refuses.
//
// One walk over the tokens, guided by the schema, serves both. Protobuf's own parser stays the
// judge of what is legal; its location tree knows neither the elements of [a, b, c] nor messages in
// a list, and its complaints name no path and no remedy, so the walk supplies those.
#pragma once

#include <google/protobuf/descriptor.h>

#include <compare>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/scene_words.hpp"

namespace farhand {

// From 1; in the order of reading.
struct ScenePosition {
  int line = 1;
  int column = 1;
  auto operator<=>(const ScenePosition&) const = default;
};

struct SceneOutline {
  // By path. A single value or an element of a list: its value; a message: its name; a list as a
  // whole: its first name.
  std::map<std::string, ScenePosition, std::less<>> positions;
  // The first thing that does not fit the schema, and where. The walk ends there.
  std::optional<SceneFault> fault;
  ScenePosition fault_position;
};

SceneOutline outline(const std::string& text, const google::protobuf::Descriptor& root);

// Position of the path, or of the nearest message around it that is there; 1:1 if none is.
ScenePosition find(const SceneOutline& outline, std::string_view path);

// The field that begins last before the position; "scene" if none does.
std::string field_at(const SceneOutline& outline, ScenePosition at);

}  // namespace farhand
