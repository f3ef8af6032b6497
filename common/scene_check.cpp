#include "common/scene_check.hpp"

#include <cmath>
#include <vector>

namespace farhand {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

std::optional<SceneFault> check_number(const FieldDescriptor& field, const std::string& path,
                                       double value) {
  const SceneRange range = range_of(field);
  if (!std::isfinite(value))
    return SceneFault{path, number(value) + " is not finite",
                      "give a number " + legal_value(field)};
  if (value < range.min)
    return SceneFault{path, quantity(field, value) + " is too small", "give " + legal_value(field)};
  if (value > range.max)
    return SceneFault{path, quantity(field, value) + " is too large", "give " + legal_value(field)};
  return {};
}

std::optional<SceneFault> check_count(const FieldDescriptor& field, const std::string& path,
                                      int count) {
  const auto& options = field.options();
  const std::string has = "has " + std::to_string(count) + (count == 1 ? " value" : " values");
  if (options.HasExtension(proto::length) && count != 0 &&
      count != options.GetExtension(proto::length))
    return SceneFault{path, has, "give " + legal_value(field)};
  if (options.HasExtension(proto::at_most) && count > options.GetExtension(proto::at_most))
    return SceneFault{path, has,
                      "give at most " + std::to_string(options.GetExtension(proto::at_most))};
  return {};
}

std::optional<SceneFault> check_message(const Message& message, const std::string& path);

// One value: index -1 for a field that is not repeated.
std::optional<SceneFault> check_value(const Message& message, const FieldDescriptor& field,
                                      const std::string& path, int index) {
  const auto& r = *message.GetReflection();
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
    return check_message(
        index < 0 ? r.GetMessage(message, &field) : r.GetRepeatedMessage(message, &field, index),
        path);
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE)
    return check_number(
        field, path,
        index < 0 ? r.GetDouble(message, &field) : r.GetRepeatedDouble(message, &field, index));
  return {};
}

std::optional<SceneFault> check_field(const Message& message, const FieldDescriptor& field,
                                      const std::string& path) {
  const auto& r = *message.GetReflection();
  const int count =
      field.is_repeated() ? r.FieldSize(message, &field) : r.HasField(message, &field);
  if (count == 0 && field.options().GetExtension(proto::needed))
    return SceneFault{path, "is missing", "add " + field.name() + ": " + legal_value(field)};
  if (!field.is_repeated())
    return count == 0 ? std::nullopt : check_value(message, field, path, -1);
  if (auto fault = check_count(field, path, count)) return fault;
  for (int i = 0; i < count; ++i)
    if (auto fault = check_value(message, field, element(path, i), i)) return fault;
  return {};
}

std::optional<SceneFault> check_message(const Message& message, const std::string& path) {
  const auto& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i)
    if (auto fault = check_field(message, *type.field(i), child(path, type.field(i)->name())))
      return fault;
  return {};
}

}  // namespace

std::optional<SceneFault> check_fields(const proto::Scene& scene) {
  return check_message(scene, "");
}

}  // namespace farhand
