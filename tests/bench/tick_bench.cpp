// Whole ticks of master and slave, without link, device and plant: from a tick with nothing
// optional, one stage more at a time, to the full scene; and the smallest scene's beside the same
// work written as a straight line. With --scenes DIR it writes the scenes, for counting their
// instructions with tests/loop/tick_cost.cpp, and times nothing.
#include <google/protobuf/text_format.h>

#include <filesystem>
#include <fstream>

#include "common/program.hpp"
#include "master/build.hpp"
#include "slave/build.hpp"
#include "tests/bench/bench_table.hpp"
#include "tests/loop/recorded_ticks.hpp"
#include "tests/loop/straight_ticks.hpp"

namespace farhand::bench {
namespace {

constexpr std::size_t kTicks = 1000;
// Of the ticks that are timed the first: pressing on the wall in the full scene, coupled in any.
constexpr std::size_t kFrom = 6500;

Scene shipped(const std::string& name) {
  return load_scene(std::filesystem::path(FARHAND_SOURCE_DIR "/deploy/scenes") /
                    (name + ".textproto"));
}

Scene reread(const proto::Scene& proto) {
  std::string text;
  google::protobuf::TextFormat::PrintToString(proto, &text);
  return parse_scene(text, "a step of the ladder");
}

struct Step {
  std::string name;  // sorts as the ladder climbs
  Scene scene;
};

// The full scene without what is optional, then with one stage more each time.
std::vector<Step> ladder() {
  const Scene full = shipped("full");
  proto::Scene scene = full.proto;
  scene.mutable_master()->clear_force_feedback();
  proto::JointPid* pid = scene.mutable_slave()->mutable_joint_pid();
  pid->clear_gravity_compensation();
  pid->clear_friction_compensation();
  pid->clear_velocity_feedforward();
  scene.mutable_slave()->clear_force_sensing();
  scene.mutable_slave()->mutable_sim_arm()->clear_force_sensor();
  std::vector<Step> out{{"0 nothing optional", reread(scene)}};
  const auto climb = [&](const char* name) { out.push_back({name, reread(scene)}); };
  pid->mutable_gravity_compensation();
  climb("1 + gravity compensation");
  *pid->mutable_friction_compensation() = full.proto.slave().joint_pid().friction_compensation();
  climb("2 + friction compensation");
  *pid->mutable_velocity_feedforward() = full.proto.slave().joint_pid().velocity_feedforward();
  climb("3 + velocity feed-forward");
  *scene.mutable_slave() = full.proto.slave();
  *scene.mutable_master()->mutable_force_feedback() = full.proto.master().force_feedback();
  climb("4 + force sensing and feedback");
  return out;
}

// Those ticks of a run that are timed; all before them bring a tick's state there.
template <typename Input>
struct Replay {
  std::vector<Input> before, timed;
  Replay(const std::vector<Input>& all, std::size_t from) {
    from = std::min(from, all.size() - kTicks);
    before.assign(all.begin(), all.begin() + static_cast<long>(from));
    timed.assign(all.begin() + static_cast<long>(from),
                 all.begin() + static_cast<long>(from + kTicks));
  }
};

// `side` ticks through the replay again and again, each time from the state at its begin.
template <typename Side, typename Input, typename Tick>
void time_ticks(Table& table, const char* subject, const std::string& contender,
                const std::string& set, Side side, const Replay<Input>& replay, Tick tick) {
  for (const Input& i : replay.before) tick(side, i);
  table.time({{{subject, contender, set}, {}}}, replay.timed.size(),
             [=, timed = replay.timed, running = side](std::size_t i) mutable {
               if (i == 0) running = side;
               return &tick(running, timed[i]);
             });
}

constexpr auto kMasterTick = [](Master& m, const MasterInput& i) -> const MasterTick& {
  m.sample(i.now, i.reading, fresh(i.in));
  return m.actuate(i.now, fresh(i.in));
};
constexpr auto kSlaveTick = [](Slave& s, const SlaveInput& i) -> const SlaveTick& {
  return s.tick(i.now, fresh(i.in), i.robot);
};

void whole_ticks(Table& table, const std::string& name, const Scene& scene) {
  const RecordedTicks all = record_ticks(scene, kFrom + kTicks);
  time_ticks(table, "tick, master", kOurs, name, Master(master_config(scene.proto)),
             Replay(all.master, kFrom), kMasterTick);
  time_ticks(table, "tick, slave", kOurs, name, Slave(slave_config(scene.proto)),
             Replay(all.slave, kFrom), kSlaveTick);
}

// The smallest scene's ticks with and without what composes them of optional stages.
void composition(Table& table) {
  const Scene scene = shipped("minimal");
  const RecordedTicks all = record_ticks(scene, kFrom + kTicks);
  const Replay master(all.master, kFrom);
  const Replay slave(all.slave, kFrom);
  const MasterConfig m = master_config(scene.proto);
  const SlaveConfig s = slave_config(scene.proto);
  time_ticks(table, "tick, master", kOurs, "minimal", Master(m), master, kMasterTick);
  time_ticks(table, "tick, master", "straight line", "minimal", StraightMaster<true>(m), master,
             [](auto& side, const MasterInput& i) -> const MasterTick& {
               return side.tick(i.now, i.reading, fresh(i.in));
             });
  time_ticks(table, "tick, slave", kOurs, "minimal", Slave(s), slave, kSlaveTick);
  time_ticks(table, "tick, slave", "straight line", "minimal", StraightSlave<true>(s), slave,
             [](auto& side, const SlaveInput& i) -> const SlaveTick& {
               return side.tick(i.now, fresh(i.in), i.robot);
             });
}

int write_scenes(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const Step& step : ladder())
    std::ofstream(folder / (step.name + ".textproto")) << step.scene.text;
  return 0;
}

int run(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--scenes") return write_scenes(argv[2]);
  Table table(argc, argv);
  composition(table);
  for (const Step& step : ladder()) whole_ticks(table, step.name, step.scene);
  for (const char* name : {"twin_delta_free", "falcon_arm", "twin_delta_contact", "full"})
    whole_ticks(table, name, shipped(name));
  return table.finish();
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  return farhand::run_guarded("bench-tick", [&] { return farhand::bench::run(argc, argv); });
}
