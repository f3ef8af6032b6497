// How the scene's schema reads in a sentence: ranges, units, names, and the nearest right spelling.
#pragma once

#include <google/protobuf/descriptor.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace farhand {

// One thing wrong with a scene. `field` is its path from the top, empty for the scene itself.
struct SceneFault {
  std::string field;
  std::string what;
  std::string remedy;
};

// Declared range of a number, infinite where the schema says nothing.
struct SceneRange {
  double min;
  double max;
};
SceneRange range_of(const google::protobuf::FieldDescriptor& field);

std::string lower(std::string_view text);

// Fit for a sentence: at most 40 characters, and '?' for whatever is not printable ASCII.
std::string shortened(std::string_view text);

// Shortest text that reads back as the same double.
std::string number(double value);

// Unit written at the end of a field's name: "max_force_newton" gives "N". Empty for a pure number.
std::string_view unit_of(std::string_view field_name);

// Number and unit: "20 N".
std::string quantity(const google::protobuf::FieldDescriptor& field, double value);

// What would be legal in this field: "a number from 0.1 to 100 N", "3 numbers ...", "one of TABLE1,
// LIBNIFALCON", ...
std::string legal_value(const google::protobuf::FieldDescriptor& field);

// "a, b and c"
std::string listed(const std::vector<std::string>& names);

std::vector<std::string> field_names(const google::protobuf::Descriptor& message);
std::vector<std::string> value_names(const google::protobuf::EnumDescriptor& values);

// The candidate with the smallest edit distance to the name (case aside), if that is near enough to
// be a slip of the pen: at most a third of the name (2 for a short one), or one begins with the
// other.
std::optional<std::string> nearest(std::string_view name,
                                   const std::vector<std::string>& candidates);

// Path of a field of the message at `path`, and of an element of it.
std::string child(std::string_view path, std::string_view field_name);
std::string element(std::string_view path, int index);

}  // namespace farhand
