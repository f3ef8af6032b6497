// farhand-loopback: master and slave of one scene in one process, in virtual time, far faster than
// real. Exit status 0 if no checker fired, 1 after an error or a violation, 2 for arguments that
// make no sense.
#include <cstdio>

#include "common/arguments.hpp"
#include "common/build_info.hpp"
#include "common/program.hpp"
#include "tests/loop/replay.hpp"
#include "tests/loop/run.hpp"
#include "tests/loop/stability/command.hpp"
#include "tests/loop/stability/study.hpp"

int main(int argc, char** argv) {
  using namespace farhand;
  Arguments arguments("both sides of a scene in one process, in virtual time", "farhand-loopback");
  ProgramOptions options;
  LoopbackOptions loop;
  std::string replay;
  bool json = false;
  bool stability = false;
  StabilityOptions about_stability;
  arguments.option("scene", options.scene, "scene file, see deploy/scenes");
  arguments.option(
      "--replay", replay,
      "the hand moves as in this recording; without a scene in the one attached to it");
  arguments.option("--record", options.record, "record both sides into this MCAP file");
  arguments.option("--trace", loop.trace, "recorded motion (CSV) for the simulated hand");
  arguments.option("--seed", loop.seed, "instead of the scene's seed");
  arguments.duration(options.duration_s, "simulated seconds, instead of the scene's");
  arguments.flag("--json", json, "print the result as JSON");
  arguments.flag("--stability", stability,
                 "where the scene stops being stable, predicted and found, and exit");
  arguments.flag("--grid", about_stability.grid,
                 "with --stability: varied over masses, gains, delays and walls; minutes");
  arguments.option("--map", about_stability.map,
                   "with --stability: draw the boundaries into this SVG file");
  arguments.flag("--plan", options.plan, "print the stages this scene runs, in order, and exit");
  arguments.flag("--check", options.check, "check the scene and exit");
  const auto missing = [&] {
    return replay.empty() && options.scene.empty() ? "scene or --replay" : "";
  };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  if (options.duration_s > 0) loop.duration_s = options.duration_s;
  return run_guarded("farhand-loopback", [&] {
    const Scene scene =
        replay.empty() ? load_scene(options.scene) : prepare_replay(replay, options.scene, loop);
    Stages stages{{"master", master_stages(scene.proto)}};
    if (scene.proto.has_slave()) stages.push_back({"slave", slave_stages(scene.proto)});
    if (print_only(options, scene, stages)) return 0;
    if (stability) {
      about_stability.json = json;
      return run_stability(scene, about_stability);
    }
    warn_each(stability_warnings(scene));
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
