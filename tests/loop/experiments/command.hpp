// farhand-loopback --experiment NAME: runs, prints the table, leaves a page with the pictures.
#pragma once

#include <string>

namespace farhand {

struct ExperimentOptions {
  std::string name;  // f1, f2, h1, h2, h3, pareto, transparency, delay or all
  std::string page = "experiments.html";
  bool json = false;  // the figures as JSON on stdout, no page
};

// Exit status: 0 if every judged figure is within its bounds, else 1. Throws a sentence for a name
// it does not know.
int run_experiments(const ExperimentOptions& options);

}  // namespace farhand
