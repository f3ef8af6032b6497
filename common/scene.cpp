#include "common/scene.hpp"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/scene_check.hpp"
#include "common/scene_outline.hpp"

namespace farhand {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

[[noreturn]] void refuse(const std::string& path, ScenePosition at, const SceneFault& fault) {
  const std::string field = fault.field.empty() ? "scene" : fault.field;
  throw SceneError(path + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " +
                       field + ": " + fault.what + "; " + fault.remedy,
                   at.line, at.column, field);
}

// The first complaint of protobuf's parser.
struct Complaint : google::protobuf::io::ErrorCollector {
  void AddError(int line, int column, const std::string& message) override {
    if (text.empty()) at = {std::max(line, 0) + 1, std::max(column, 0) + 1}, text = message;
  }
  ScenePosition at;
  std::string text;
};

// Bytes that must follow one in UTF-8; nothing for a byte that begins no character of a text.
std::optional<int> following(unsigned char byte) {
  if (byte == '\n' || byte == '\t' || byte == '\r' || (byte >= 0x20 && byte < 0x7F)) return 0;
  if (byte < 0xC2 || byte > 0xF4) return {};
  return byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
}

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// Control characters and broken UTF-8 say that this was never written as a scene.
void check_text(std::string_view text, const std::string& path) {
  ScenePosition at;
  while (!text.empty()) {
    const auto more = following(static_cast<unsigned char>(text[0]));
    const auto rest = text.substr(1, static_cast<std::size_t>(more.value_or(0)));
    if (!more || static_cast<int>(rest.size()) < *more ||
        !std::all_of(rest.begin(), rest.end(), continues))
      refuse(
          path, at,
          {"", "this is not a text file", "give a scene in protobuf text format, saved as UTF-8"});
    at = text[0] == '\n' ? ScenePosition{at.line + 1, 1}
                         : ScenePosition{at.line, at.column + 1 + *more};
    text.remove_prefix(1 + rest.size());
  }
}

proto::Scene parse(const std::string& text, const std::string& path, const SceneOutline& places) {
  proto::Scene scene;
  Complaint complaint;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&complaint);
  if (parser.ParseFromString(text, &scene)) return scene;
  // Protobuf notices what stands at a name only after it; anything the walk minds later is a
  // consequence.
  if (places.fault && places.fault_position <= complaint.at)
    refuse(path, places.fault_position, *places.fault);
  refuse(path, complaint.at,
         {field_at(places, complaint.at), complaint.text, "correct the text here"});
}

// Every default becomes a value, every local field goes. -0 becomes 0, which it equals.
void normalise(Message& message);

void normalise_field(Message& message, const FieldDescriptor& field) {
  const auto& r = *message.GetReflection();
  if (field.options().GetExtension(proto::local)) return r.ClearField(&message, &field);
  if (field.containing_oneof() != nullptr && !r.HasField(message, &field)) return;
  const bool nested = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
  const bool number = field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE;
  if (field.is_repeated()) {
    for (int i = 0; i < r.FieldSize(message, &field); ++i) {
      if (nested) normalise(*r.MutableRepeatedMessage(&message, &field, i));
      if (number)
        r.SetRepeatedDouble(&message, &field, i, r.GetRepeatedDouble(message, &field, i) + 0.0);
    }
    return;
  }
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      if (r.HasField(message, &field)) normalise(*r.MutableMessage(&message, &field));
      return;
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return r.SetDouble(&message, &field, r.GetDouble(message, &field) + 0.0);
    case FieldDescriptor::CPPTYPE_BOOL:
      return r.SetBool(&message, &field, r.GetBool(message, &field));
    case FieldDescriptor::CPPTYPE_ENUM:
      return r.SetEnumValue(&message, &field, r.GetEnumValue(message, &field));
    case FieldDescriptor::CPPTYPE_UINT64:
      return r.SetUInt64(&message, &field, r.GetUInt64(message, &field));
    case FieldDescriptor::CPPTYPE_STRING:
      return r.SetString(&message, &field, r.GetString(message, &field));
    default:
      throw std::logic_error("proto/scene: " + field.full_name() +
                             " has a type the hash does not know");
  }
}

void normalise(Message& message) {
  const auto& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) normalise_field(message, *type.field(i));
}

}  // namespace

std::uint64_t shared_hash(const proto::Scene& scene) {
  proto::Scene shared = scene;
  normalise(shared);
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : shared.SerializeAsString())  // no maps and no unknown fields: deterministic
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

Scene parse_scene(std::string text, std::string path) {
  check_text(text, path);
  const SceneOutline places = outline(text, *proto::Scene::descriptor());
  proto::Scene scene = parse(text, path, places);
  if (places.positions.empty())
    refuse(path, {}, {"", "nothing is in this file", "start from deploy/scenes/minimal.textproto"});
  for (const auto check : {check_fields, check_rules})
    if (const auto fault = check(scene)) refuse(path, find(places, fault->field), *fault);
  const std::uint64_t hash = shared_hash(scene);
  return {std::move(scene), std::move(path), std::move(text), hash};
}

Scene load_scene(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const std::string name = path.string();
  if (std::filesystem::is_directory(status))
    refuse(name, {},
           {"", "this is a directory", "name a scene file, such as one in deploy/scenes"});
  std::ifstream in(path, std::ios::binary);
  if (!in)
    refuse(name, {},
           {"", "the file cannot be opened",
            "give the path of a scene file that exists and is readable"});
  std::string text(kMaxSceneBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad()) refuse(name, {}, {"", "the file cannot be read", "check the file and its disk"});
  if (text.size() > kMaxSceneBytes)
    refuse(name, {},
           {"", "the file is larger than 1 MiB",
            "give a scene; a recorded motion belongs in a trace file"});
  return parse_scene(std::move(text), name);
}

std::filesystem::path beside(const Scene& scene, const std::string& file) {
  return std::filesystem::path(scene.path).parent_path() / file;
}

}  // namespace farhand
