// Every field of the schema, found by reflection: nothing here has to change when the schema grows.
#include "common/scene_check.hpp"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/scene.hpp"

namespace farhand {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

using Chain = std::vector<const FieldDescriptor*>;  // from the scene down to a field

void collect(const Descriptor& type, Chain& above, std::vector<Chain>& out) {
  for (int i = 0; i < type.field_count(); ++i) {
    above.push_back(type.field(i));
    out.push_back(above);
    if (type.field(i)->message_type() != nullptr)
      collect(*type.field(i)->message_type(), above, out);
    above.pop_back();
  }
}

std::vector<Chain> all_chains() {
  std::vector<Chain> out;
  Chain above;
  collect(*proto::Scene::descriptor(), above, out);
  return out;
}

std::vector<Chain> numbers() {
  std::vector<Chain> out;
  for (const Chain& chain : all_chains())
    if (chain.back()->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) out.push_back(chain);
  return out;
}

std::string path_of(const Chain& chain) {
  std::string path;
  for (const auto* field : chain) {
    path = child(path, field->name());
    if (field->is_repeated() && field != chain.back()) path = element(path, 0);
  }
  return path;
}

int length_of(const FieldDescriptor& field) {
  return field.options().HasExtension(proto::length) ? field.options().GetExtension(proto::length)
                                                     : 1;
}

// Fills the field with the value, every element of a list.
void set(Message& m, const FieldDescriptor& field, double value) {
  const auto& r = *m.GetReflection();
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_ENUM)
    return r.SetEnumValue(&m, &field, static_cast<int>(value));
  if (!field.is_repeated()) return r.SetDouble(&m, &field, value);
  r.ClearField(&m, &field);
  for (int i = 0; i < length_of(field); ++i) r.AddDouble(&m, &field, value);
}

// What the message needs, legal.
void fill_needed(Message& m) {
  for (int i = 0; i < m.GetDescriptor()->field_count(); ++i) {
    const auto& field = *m.GetDescriptor()->field(i);
    if (!field.options().GetExtension(proto::needed)) continue;
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
      fill_needed(*m.GetReflection()->MutableMessage(&m, &field));
    else if (field.cpp_type() == FieldDescriptor::CPPTYPE_STRING)
      m.GetReflection()->SetString(&m, &field, "a");
    else
      set(m, field, field.cpp_type() == FieldDescriptor::CPPTYPE_ENUM ? 0 : range_of(field).max);
  }
}

// The message that holds the chain's last field, with all messages above it; what each of them
// needs is there and legal.
Message& build(proto::Scene& scene, const Chain& chain) {
  Message* m = &scene;
  for (std::size_t level = 0; level < chain.size(); ++level) {
    fill_needed(*m);
    if (level + 1 == chain.size()) break;
    const auto& r = *m->GetReflection();
    m = chain[level]->is_repeated() ? r.AddMessage(m, chain[level])
                                    : r.MutableMessage(m, chain[level]);
  }
  return *m;
}

// Through text and the parser, as a person's mistake would come.
std::string refused_field(const proto::Scene& scene) {
  std::string text;
  google::protobuf::TextFormat::PrintToString(scene, &text);
  try {
    parse_scene(text, "test");
  } catch (const SceneError& error) {
    return error.field;
  }
  return "accepted";
}

TEST(SceneSchema, HasNumbersToLookAt) {
  EXPECT_GT(numbers().size(), 100u);
}

TEST(SceneSchema, EveryNumberHasARangeAUnitAndALegalDefault) {
  // Pure numbers.
  const std::set<std::string> kUnitless = {"gear_ratio",
                                           "normal",
                                           "normal_in_slave",
                                           "towards",
                                           "direction",
                                           "up_in_master",
                                           "wrist_margin",
                                           "elbow_margin",
                                           "user_force_share",
                                           "scale",
                                           "force_scale",
                                           "rotation_scale",
                                           "damping_ratio",
                                           "share",
                                           "model_share",
                                           "gravity_share",
                                           "damping_share",
                                           "friction_share",
                                           "inertia_share",
                                           "rotation_inertia_share",
                                           "switching_rate_share",
                                           "motor_gain",
                                           "kp",
                                           "friction_coefficient",
                                           "loss_ratio",
                                           "burst_enter_ratio",
                                           "burst_leave_ratio",
                                           "duplicate_ratio",
                                           "reorder_ratio",
                                           "corrupt_ratio"};
  // Left out, another field's value holds, or nothing is asked for.
  const std::set<std::string> kInherits = {"farhand.proto.ForceGains.cutoff_hz",
                                           "farhand.proto.Workspace.alignment_deg"};
  for (const Chain& chain : numbers()) {
    const FieldDescriptor& field = *chain.back();
    const SceneRange range = range_of(field);
    EXPECT_TRUE(std::isfinite(range.min) && std::isfinite(range.max) && range.min < range.max)
        << field.full_name();
    EXPECT_NE(unit_of(field.name()).empty(), !kUnitless.contains(field.name()))
        << field.full_name();
    const bool needed = field.options().GetExtension(proto::needed);
    if (field.is_repeated()) continue;
    if (kInherits.contains(field.full_name())) {
      EXPECT_FALSE(needed || field.has_default_value()) << field.full_name();
      continue;
    }
    EXPECT_NE(field.has_default_value(), needed)
        << field.full_name() << " has a default or is needed, not both";
    if (needed) continue;
    EXPECT_GE(field.default_value_double(), range.min) << field.full_name();
    EXPECT_LE(field.default_value_double(), range.max) << field.full_name();
  }
}

TEST(SceneSchema, EveryListIsBounded) {
  for (const Chain& chain : all_chains())
    if (chain.back()->is_repeated()) {
      const auto& options = chain.back()->options();
      EXPECT_NE(options.HasExtension(proto::length), options.HasExtension(proto::at_most))
          << chain.back()->full_name();
    }
}

TEST(SceneSchema, HasOnlyTypesThatAreChecked) {
  for (const Chain& chain : all_chains()) {
    const auto type = chain.back()->cpp_type();
    EXPECT_TRUE(type == FieldDescriptor::CPPTYPE_DOUBLE || type == FieldDescriptor::CPPTYPE_BOOL ||
                type == FieldDescriptor::CPPTYPE_ENUM || type == FieldDescriptor::CPPTYPE_STRING ||
                type == FieldDescriptor::CPPTYPE_MESSAGE || type == FieldDescriptor::CPPTYPE_UINT64)
        << chain.back()->full_name();
  }
}

TEST(SceneCheck, EveryNumberOutsideItsRangeIsRefusedWithItsPath) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Chain& chain : numbers()) {
    const FieldDescriptor& field = *chain.back();
    const SceneRange range = range_of(field);
    const std::string path = path_of(chain) + (field.is_repeated() ? "[0]" : "");
    for (const double bad : {std::nextafter(range.min, -kInfinity), range.min - 1,
                             std::nextafter(range.max, kInfinity), range.max * 2 + 1, kInfinity,
                             -kInfinity, std::nan("")}) {
      proto::Scene scene;
      set(build(scene, chain), field, bad);
      EXPECT_EQ(refused_field(scene), path) << bad;
    }
  }
}

TEST(SceneCheck, TheEndsOfEveryRangeAreLegal) {
  for (const Chain& chain : numbers())
    for (const double good : {range_of(*chain.back()).min, range_of(*chain.back()).max}) {
      proto::Scene scene;
      set(build(scene, chain), *chain.back(), good);
      const auto fault = check_fields(scene);
      EXPECT_FALSE(fault) << path_of(chain) << " = " << good << ": " << fault->field << " "
                          << fault->what;
    }
}

TEST(SceneCheck, ALastElementOutOfRangeIsNamed) {
  for (const Chain& chain : numbers()) {
    const FieldDescriptor& field = *chain.back();
    if (!field.is_repeated()) continue;
    proto::Scene scene;
    Message& m = build(scene, chain);
    set(m, field, range_of(field).min);
    const int last = length_of(field) - 1;
    m.GetReflection()->SetRepeatedDouble(&m, &field, last, 2 * range_of(field).max);
    EXPECT_EQ(refused_field(scene), element(path_of(chain), last));
  }
}

TEST(SceneCheck, EveryListOfTheWrongLengthIsRefused) {
  for (const Chain& chain : all_chains()) {
    const FieldDescriptor& field = *chain.back();
    if (!field.is_repeated()) continue;
    proto::Scene scene;
    Message& m = build(scene, chain);
    const auto& r = *m.GetReflection();
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
      set(m, field, range_of(field).min);
      r.AddDouble(&m, &field, range_of(field).min);
    } else {
      for (int i = 0; i <= field.options().GetExtension(proto::at_most); ++i)
        r.AddMessage(&m, &field);
    }
    EXPECT_EQ(refused_field(scene), path_of(chain));
  }
}

TEST(SceneCheck, EveryNeededFieldIsMissed) {
  int seen = 0;
  for (const Chain& chain : all_chains()) {
    if (!chain.back()->options().GetExtension(proto::needed)) continue;
    proto::Scene scene;
    Message& m = build(scene, chain);
    m.GetReflection()->ClearField(&m, chain.back());
    EXPECT_EQ(refused_field(scene), path_of(chain));
    ++seen;
  }
  EXPECT_GE(seen, 10);
}

bool marked_local(const FieldDescriptor* field) {
  return field->options().GetExtension(proto::local);
}

bool is_local(const Chain& chain) {
  return std::any_of(chain.begin(), chain.end(), marked_local);
}

// Another legal value than the default.
void change(Message& m, const FieldDescriptor& field) {
  const auto& r = *m.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return r.SetBool(&m, &field, !r.GetBool(m, &field));
    case FieldDescriptor::CPPTYPE_ENUM:
      return r.SetEnumValue(&m, &field, r.GetEnumValue(m, &field) == 1 ? 0 : 1);
    case FieldDescriptor::CPPTYPE_STRING:
      return r.SetString(&m, &field, r.GetString(m, &field) + "x");
    case FieldDescriptor::CPPTYPE_UINT64:
      return r.SetUInt64(&m, &field, r.GetUInt64(m, &field) + 1);
    case FieldDescriptor::CPPTYPE_MESSAGE:
      field.is_repeated() ? r.AddMessage(&m, &field) : r.MutableMessage(&m, &field);
      return;
    default:
      break;
  }
  const bool at_max = !field.is_repeated() && r.GetDouble(m, &field) == range_of(field).max;
  set(m, field, at_max ? range_of(field).min : range_of(field).max);
}

TEST(SceneHash, AFieldLeftOutAndItsDefaultGivenHashAlike) {
  for (const Chain& chain : all_chains()) {
    const FieldDescriptor& field = *chain.back();
    if (field.is_repeated() || field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (field.options().GetExtension(proto::needed)) continue;
    proto::Scene scene;
    Message& m = build(scene, chain);
    const std::uint64_t without = shared_hash(scene);
    const auto& r = *m.GetReflection();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        r.SetDouble(&m, &field, r.GetDouble(m, &field));
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        r.SetBool(&m, &field, r.GetBool(m, &field));
        break;
      case FieldDescriptor::CPPTYPE_ENUM:
        r.SetEnumValue(&m, &field, r.GetEnumValue(m, &field));
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        r.SetString(&m, &field, r.GetString(m, &field));
        break;
      default:
        r.SetUInt64(&m, &field, r.GetUInt64(m, &field));
    }
    ASSERT_TRUE(r.HasField(m, &field));
    EXPECT_EQ(shared_hash(scene), without) << path_of(chain);
  }
}

TEST(SceneHash, ChangesWithEverySharedFieldAndWithNoLocalOne) {
  int shared = 0, local = 0;
  for (const Chain& chain : all_chains()) {
    proto::Scene scene;
    Message& m = build(scene, chain);
    // What is needed has no default to differ from.
    const bool needed = chain.back()->options().GetExtension(proto::needed);
    if (needed) m.GetReflection()->ClearField(&m, chain.back());
    const std::uint64_t before = shared_hash(scene);
    change(m, *chain.back());
    EXPECT_EQ(shared_hash(scene) == before, is_local(chain)) << path_of(chain);
    ++(is_local(chain) ? local : shared);
  }
  EXPECT_GT(shared, 50);
  EXPECT_GT(local, 50);
}

TEST(SceneHash, IsSharedWhereBothSidesDependOnIt) {
  const std::set<std::string> kLocal = {"description",
                                        "seed",
                                        "duration_s",
                                        "master.sim_hand",
                                        "master.ahrs.accelerometer",
                                        "master.ahrs.latency_ms",
                                        "master.ahrs.magnetometer",
                                        "master.ahrs.rate_hz",
                                        "master.ahrs.sensor_position_m",
                                        "master.ahrs.sensor_roll_pitch_yaw_deg",
                                        "master.ahrs.serial",
                                        "master.ahrs.simulated",
                                        "master.ahrs.up_in_master",
                                        "master.falcon_usb",
                                        "slave.sim_arm",
                                        "link.slave_address",
                                        "link.master_address",
                                        "link.insecure",
                                        "link.key_file",
                                        "link.certificates",
                                        "link.to_slave",
                                        "link.to_master",
                                        "link.observer_address",
                                        "master.falcon_usb",
                                        "master.realtime",
                                        "slave.realtime"};
  std::set<std::string> found;
  for (const Chain& chain : all_chains())
    if (marked_local(chain.back()) && std::none_of(chain.begin(), chain.end() - 1, marked_local))
      found.insert(path_of(chain));
  EXPECT_EQ(found, kLocal);
}

}  // namespace
}  // namespace farhand
