#include "common/scene_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "proto/scene.pb.h"

namespace farhand {
namespace {

using google::protobuf::FieldDescriptor;

struct Unit {
  std::string_view suffix;
  std::string_view text;
};
constexpr std::array<Unit, 29> kUnits = {{{"newton_per_m_s", "N/(m s)"},
                                          {"newton_s_per_m", "N s/m"},
                                          {"newton_per_m", "N/m"},
                                          {"newton_meter_per_s", "N m/s"},
                                          {"newton_meter", "N m"},
                                          {"newton_m_per_rad", "N m/rad"},
                                          {"newton_m_s", "N m s"},
                                          {"newton_m", "N m"},
                                          {"newton_per_s", "N/s"},
                                          {"newton", "N"},
                                          {"joule", "J"},
                                          {"kg_m2", "kg m^2"},
                                          {"kg", "kg"},
                                          {"m_per_s", "m/s"},
                                          {"m_per_s2", "m/s^2"},
                                          {"microtesla", "uT"},
                                          {"deg_per_s", "deg/s"},
                                          {"rad_per_s", "rad/s"},
                                          {"ms_per_s", "ms/s"},
                                          {"kbit_per_s", "kbit/s"},
                                          {"per_s", "1/s"},
                                          {"hz", "Hz"},
                                          {"bytes", "bytes"},
                                          {"ms", "ms"},
                                          {"us", "us"},
                                          {"s", "s"},
                                          {"rad", "rad"},
                                          {"deg", "deg"},
                                          {"m", "m"}}};

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t swap = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({swap, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string kind_of_value(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_STRING:
      return "text in double quotes";
    case FieldDescriptor::CPPTYPE_ENUM:
      return "one of " + listed(value_names(*field.enum_type()));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return "a message in braces, " + field.name() + " { ... }";
    case FieldDescriptor::CPPTYPE_UINT64:
      return "a whole number from 0 to " +
             std::to_string(std::numeric_limits<std::uint64_t>::max());
    default:
      break;
  }
  const SceneRange range = range_of(field);
  return "from " + number(range.min) + " to " + quantity(field, range.max);
}

}  // namespace

SceneRange range_of(const FieldDescriptor& field) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto& options = field.options();
  return {options.HasExtension(proto::min) ? options.GetExtension(proto::min) : -kInfinity,
          options.HasExtension(proto::max) ? options.GetExtension(proto::max) : kInfinity};
}

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out(text.substr(0, kLongest));
  for (char& c : out)
    if (c < 0x20 || c > 0x7E) c = '?';
  return text.size() > kLongest ? out + "..." : out;
}

std::string number(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string_view unit_of(std::string_view field_name) {
  for (const Unit& unit : kUnits)
    if (field_name == unit.suffix ||
        (field_name.ends_with(unit.suffix) &&
         field_name[field_name.size() - unit.suffix.size() - 1] == '_'))
      return unit.text;
  return {};
}

std::string quantity(const FieldDescriptor& field, double value) {
  const std::string_view unit = unit_of(field.name());
  return number(value) + (unit.empty() ? "" : " ") + std::string(unit);
}

std::string legal_value(const FieldDescriptor& field) {
  const auto& options = field.options();
  const std::string one = kind_of_value(field);
  if (options.HasExtension(proto::length))
    return std::to_string(options.GetExtension(proto::length)) + " numbers, each " + one;
  return one;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

std::vector<std::string> field_names(const google::protobuf::Descriptor& message) {
  std::vector<std::string> out;
  for (int i = 0; i < message.field_count(); ++i) out.push_back(message.field(i)->name());
  return out;
}

std::vector<std::string> value_names(const google::protobuf::EnumDescriptor& values) {
  std::vector<std::string> out;
  for (int i = 0; i < values.value_count(); ++i) out.push_back(values.value(i)->name());
  return out;
}

std::optional<std::string> nearest(std::string_view name,
                                   const std::vector<std::string>& candidates) {
  std::optional<std::string> best;
  std::size_t best_distance = (name.size() < 4 ? 1 : std::max<std::size_t>(2, name.size() / 3)) + 1;
  const std::string wanted = lower(name);
  for (const std::string& candidate : candidates) {
    const std::string have = lower(candidate);
    const bool begins =
        wanted.size() >= 3 && (have.starts_with(wanted) || wanted.starts_with(have));
    const std::size_t distance = begins ? std::min<std::size_t>(1, edit_distance(wanted, have))
                                        : edit_distance(wanted, have);
    if (distance < best_distance) best = candidate, best_distance = distance;
  }
  return best;
}

std::string child(std::string_view path, std::string_view field_name) {
  return std::string(path) + (path.empty() ? "" : ".") + std::string(field_name);
}

std::string element(std::string_view path, int index) {
  return std::string(path) + "[" + std::to_string(index) + "]";
}

}  // namespace farhand
