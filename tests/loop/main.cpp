// farhand-loopback: master and slave of one scene in one process, in virtual time, far faster than
// real. Exit status 0 if no checker fired, 1 after an error or a violation, 2 for arguments that
// make no sense.
#include <cstdio>

#include "common/arguments.hpp"
#include "common/build_info.hpp"
#include "common/program.hpp"
#include "common/scene_network.hpp"
#include "tests/loop/replay.hpp"
#include "tests/loop/run.hpp"
#include "tests/loop/studies.hpp"

int main(int argc, char** argv) {
  using namespace farhand;
  Arguments arguments("both sides of a scene in one process, in virtual time", "farhand-loopback");
  ProgramOptions options;
  LoopbackOptions loop;
  std::string replay;
  bool json = false;
  Studies studies;
  arguments.option("scene", options.scene, "scene file, see deploy/scenes");
  arguments.option(
      "--replay", replay,
      "the hand moves as in this recording; without a scene in the one attached to it");
  arguments.option("--record", options.record, "record both sides into this MCAP file");
  arguments.option("--trace", loop.trace, "recorded motion (CSV) for the simulated hand");
  arguments.option("--seed", loop.seed, "instead of the scene's seed");
  arguments.duration(options.duration_s, "simulated seconds, instead of the scene's");
  arguments.flag("--json", json, "print the result as JSON");
  studies.add_to(arguments);
  arguments.flag("--plan", options.plan, "print the stages this scene runs, in order, and exit");
  arguments.flag("--check", options.check, "check the scene and exit");
  const auto missing = [&] {
    const bool given = !replay.empty() || !options.scene.empty() || !studies.needs_scene();
    return given ? "" : "scene or --replay";
  };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  if (options.duration_s > 0) loop.duration_s = options.duration_s;
  return run_guarded("farhand-loopback", [&] {
    if (!studies.needs_scene()) return studies.run(nullptr, json).value_or(0);
    const Scene scene =
        replay.empty() ? load_scene(options.scene) : prepare_replay(replay, options.scene, loop);
    Stages stages{{"master", master_stages(scene.proto)}};
    if (scene.proto.has_slave()) {
      stages.push_back({"network", network_stages(scene.proto.link())});
      stages.push_back({"slave", slave_stages(scene.proto)});
    }
    if (print_only(options, scene, stages)) return 0;
    if (const auto status = studies.run(&scene, json)) return *status;
    warn_each(studies.warnings(scene));
    std::optional<RecordingFile> file;
    if (options.record)
      file.emplace(*options.record, scene, about_loopback(scene, loop, build_info()),
                   std::vector{loop.trace.value_or(""), replay});
    const RunResult result = run_scene(scene, loop, file ? &*file : nullptr);
    std::fputs((json ? to_json(result) : to_text(result)).c_str(), stdout);
    if (file) std::fputs(file->end().c_str(), json ? stderr : stdout);
    return result.good() ? 0 : 1;
  });
}
