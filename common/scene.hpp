// A scene file (proto/scene.proto in protobuf text format): read, checked, and hashed. Everything
// is refused here, at start, in one line a person can act on; past this point a scene's numbers
// need no further check.
//
//   file:line:column: field.path: what is wrong; what would be right
//
// Lines and columns count from 1 and point at the value at fault, or, for something missing, at the
// message that lacks it (1:1 for the file); tabs reach to the next multiple of 8. Elements of
// repeated fields count from 0, as in master.sim_hand.push[1].force_newton[2]. Only the first fault
// is told.
//
// Checked, in this order: the file is readable, small enough and text; protobuf accepts it, so
// field names, types and duplicates are right; every number is finite and within the range its
// field declares, every list has its length, nothing needed is missing; the parts fit together (the
// tables of scene_rules.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "proto/scene.pb.h"

namespace farhand {

struct Scene {
  proto::Scene proto;
  std::string path;  // as given, for messages and for files named relative to it
  std::string text;  // as read, for the recorder
  // Equal on both sides or they do not talk: see shared_hash below.
  std::uint64_t shared_hash = 0;
};

// what() is the line above; the members are its parts.
struct SceneError : std::runtime_error {
  SceneError(const std::string& what, int at_line, int at_column, std::string at_field)
      : std::runtime_error(what), line(at_line), column(at_column), field(std::move(at_field)) {}
  int line;
  int column;
  std::string field;  // "scene" for the file as a whole
};

inline constexpr std::size_t kMaxSceneBytes = 1 << 20;

// Throws SceneError.
Scene load_scene(const std::filesystem::path& path);
// The same for text already in memory; path is only named in messages.
Scene parse_scene(std::string text, std::string path);

// A file that a scene names is found from where the scene lies; one that the command line names,
// from where the user stands.
std::filesystem::path beside(const Scene& scene, const std::string& file);

// FNV-1a (64 bit) of what both sides must agree on: the scene with every field marked local taken
// out and every default written out, so that a field left out and its default given hash alike.
// Present and absent messages differ, since presence means a stage. Local are descriptions, seeds,
// run lengths, addresses, impairments, what is asked of a machine's system, and the insides of
// devices: two machines may simulate differently, or one of them not at all. Shared are
// the tick rate, the handle and its geometry, the force feedback and sensing, the workspace, the
// servos, and the link's times. Every build of one schema gives the same value; a schema with
// another shared field gives another, on purpose.
std::uint64_t shared_hash(const proto::Scene& scene);

}  // namespace farhand
