#include "common/scene_rules.hpp"

#include "common/scene_check.hpp"

namespace farhand {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using proto::Scene;

// The value that the sentence is about, where it can be said in a word.
std::string subject(const Message& m, const std::string& name) {
  const FieldDescriptor* field = m.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr || field->is_repeated()) return "";
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE)
    return quantity(*field, m.GetReflection()->GetDouble(m, field)) + " ";
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_STRING)
    return "'" + shortened(m.GetReflection()->GetString(m, field)) + "' ";
  return "";
}

std::optional<SceneFault> ask(const SceneRule& rule, const Scene& scene, const Message& m,
                              const std::string& path) {
  const std::string where = rule.field.empty() ? path : child(path, rule.field);
  const int count =
      rule.each ? m.GetReflection()->FieldSize(m, m.GetDescriptor()->FindFieldByName(rule.field))
                : 1;
  for (int i = 0; i < count; ++i)
    if (rule.broken(scene, m, i))
      return SceneFault{rule.each ? element(where, i) : where, subject(m, rule.field) + rule.what,
                        rule.remedy};
  return {};
}

std::optional<SceneFault> ask_all(const SceneRules& rules, const Scene& scene, const Message& m,
                                  const std::string& path) {
  for (const SceneRule& rule : rules)
    if (rule.type == m.GetDescriptor())
      if (auto fault = ask(rule, scene, m, path)) return fault;
  std::vector<const FieldDescriptor*> fields;
  const auto& r = *m.GetReflection();
  r.ListFields(m, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const std::string here = child(path, field->name());
    const int count = field->is_repeated() ? r.FieldSize(m, field) : 1;
    for (int i = 0; i < count; ++i) {
      const bool list = field->is_repeated();
      const Message& inner = list ? r.GetRepeatedMessage(m, field, i) : r.GetMessage(m, field);
      if (auto fault = ask_all(rules, scene, inner, list ? element(here, i) : here)) return fault;
    }
  }
  return {};
}

}  // namespace

std::optional<SceneFault> check_rules(const Scene& scene) {
  SceneRules rules;
  add_master_rules(rules);
  add_ahrs_rules(rules);
  add_slave_rules(rules);
  add_bilateral_rules(rules);
  add_compensation_rules(rules);
  add_deadband_rules(rules);
  if (auto fault = ask_all(rules, scene, scene, "")) return fault;
  // A link left out is a link of defaults, which must suit the tick rate too.
  return scene.has_slave() && !scene.has_link() ? ask_all(rules, scene, scene.link(), "link")
                                                : std::nullopt;
}

}  // namespace farhand
