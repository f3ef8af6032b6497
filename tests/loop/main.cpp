// farhand-loopback: master and slave of one scene in one process, in virtual time, far faster than
// real. Exit status 0 if no checker fired, 1 after an error or a violation, 2 for arguments that
// make no sense.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/program.hpp"
#include "tests/loop/run.hpp"

int main(int argc, char** argv) {
  using namespace farhand;
  CLI::App app("both sides of a scene in one process, in virtual time", "farhand-loopback");
  ProgramOptions options;
  LoopbackOptions loop;
  bool json = false;
  app.add_option("scene", options.scene, "scene file, see deploy/scenes")->required();
  app.add_option("--trace", loop.trace, "recorded motion (CSV) for the simulated hand");
  app.add_option("--seed", loop.seed, "instead of the scene's seed");
  add_duration_option(app, options.duration_s, "simulated seconds, instead of the scene's");
  app.add_flag("--json", json, "print the result as JSON");
  app.add_flag("--plan", options.plan, "print the stages this scene runs, in order, and exit");
  app.add_flag("--check", options.check, "check the scene and exit");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (options.duration_s > 0) loop.duration_s = options.duration_s;
  return run_guarded("farhand-loopback", [&] {
    const Scene scene = load_scene(options.scene);
    Stages stages{{"master", master_stages(scene.proto)}};
    if (scene.proto.has_slave()) stages.push_back({"slave", slave_stages(scene.proto)});
    if (print_only(options, scene, stages)) return 0;
    const RunResult result = run_scene(scene, loop);
    std::fputs((json ? to_json(result) : to_text(result)).c_str(), stdout);
    return result.good() ? 0 : 1;
  });
}
