// How a rule about the parts of a scene is written; the tables are in scene_rules_master.cpp,
// scene_rules_slave.cpp and scene_rules_bilateral.cpp.
//
// A rule belongs to a message type and is asked wherever a message of that type stands. Its
// sentence follows the path of the field it blames and, for a number or text, that field's value.
#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "proto/scene.pb.h"

namespace farhand {

struct SceneRule {
  const google::protobuf::Descriptor* type;
  std::string field;  // the one to blame, below the message; empty: the message itself
  bool each;          // asked for every element of the field
  std::function<bool(const proto::Scene&, const google::protobuf::Message&, int index)> broken;
  std::string what;
  std::string remedy;
};
using SceneRules = std::vector<SceneRule>;

// The tables.
void add_master_rules(SceneRules& rules);  // the scene as a whole and the master's side
void add_ahrs_rules(SceneRules& rules);    // how a Falcon's grip is turned
void add_slave_rules(SceneRules& rules);   // the slave's side and the link
void add_bilateral_rules(SceneRules& rules);
void add_compensation_rules(SceneRules& rules);
void add_deadband_rules(SceneRules& rules);

// broken(message) or broken(scene, message)
template <typename M, typename F>
void rule(SceneRules& rules, std::string field, F broken, std::string what, std::string remedy) {
  const auto ask = [broken](const proto::Scene& s, const google::protobuf::Message& m, int) {
    if constexpr (std::is_invocable_v<F, const M&>)
      return broken(static_cast<const M&>(m));
    else
      return broken(s, static_cast<const M&>(m));
  };
  rules.push_back(
      {M::descriptor(), std::move(field), false, ask, std::move(what), std::move(remedy)});
}

// broken(message, index)
template <typename M, typename F>
void each(SceneRules& rules, std::string field, F broken, std::string what, std::string remedy) {
  const auto ask = [broken](const proto::Scene&, const google::protobuf::Message& m, int i) {
    return broken(static_cast<const M&>(m), i);
  };
  rules.push_back(
      {M::descriptor(), std::move(field), true, ask, std::move(what), std::move(remedy)});
}

// The danger cue of position control takes what the robot presses on for a danger.
inline bool cue_of_contact(const proto::Scene& s) {
  return s.master().position_control().danger_cue().contact_newton() > 0;
}

// Sampling cannot tell higher frequencies from lower ones. 0 means no filter.
template <typename M>
void below_half_the_rate(SceneRules& rules, const char* name) {
  const auto* field = M::descriptor()->FindFieldByName(name);
  rule<M>(
      rules, name,
      [field](const proto::Scene& s, const M& m) {
        return 2 * m.GetReflection()->GetDouble(m, field) >= s.rate_hz();
      },
      "is not below half the tick rate", "lower it, or raise the scene's rate_hz");
}

inline double norm(const google::protobuf::RepeatedField<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

inline bool given(const google::protobuf::Message& m,
                  const google::protobuf::FieldDescriptor& field) {
  const auto& r = *m.GetReflection();
  return field.is_repeated() ? r.FieldSize(m, &field) > 0 : r.HasField(m, &field);
}

// A Falcon moves in three translations and its grip senses no force.
template <typename M>
void not_on_falcon(SceneRules& rules, std::initializer_list<const char*> fields) {
  for (const char* name : fields) {
    const auto* field = M::descriptor()->FindFieldByName(name);
    rule<M>(
        rules, name,
        [field](const proto::Scene& s, const M& m) {
          return s.master().has_falcon() && given(m, *field);
        },
        "means nothing on a Falcon, which neither turns nor feels force",
        "remove it, or use the twin_delta handle");
  }
}

}  // namespace farhand
