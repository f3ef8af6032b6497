#include "tests/loop/studies.hpp"

#include "tests/loop/stability/study.hpp"

namespace farhand {

void Studies::add_to(Arguments& arguments) {
  arguments.option("--experiment", experiment_.name,
                   "an experiment of the publications instead of a scene: f1, f2, h1, h2, h3, "
                   "pareto, transparency, delay, or all");
  arguments.option("--page", experiment_.page,
                   "with --experiment: where its pictures go, experiments.html");
  arguments.flag("--stability", stability_.asked,
                 "where the scene stops being stable, predicted and found, and exit");
  arguments.flag("--grid", stability_.grid,
                 "with --stability: varied over masses, gains, delays and walls; minutes");
  arguments.option("--map", stability_.map,
                   "with --stability: draw the boundaries into this SVG file");
}

std::optional<int> Studies::run(const Scene* scene, bool json) {
  experiment_.json = stability_.json = json;
  if (!experiment_.name.empty()) return run_experiments(experiment_);
  if (stability_.asked) return run_stability(*scene, stability_);
  return {};
}

std::vector<std::string> Studies::warnings(const Scene& scene) const {
  return stability_warnings(scene);
}

}  // namespace farhand
