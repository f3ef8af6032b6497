#include "tests/loop/experiments/command.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "common/report/html_page.hpp"
#include "tests/loop/experiments/experiment.hpp"

namespace farhand {
namespace {

struct Named {
  const char* name;
  Experiment (*run)();
};
constexpr Named kExperiments[] = {
    {"f1", falcon_step},         {"f2", falcon_pushes},    {"h1", free_motion_one_axis},
    {"h1", free_motion_full},    {"h2", contact_one_axis}, {"h2", contact_full},
    {"pareto", pareto_one_axis}, {"pareto", pareto_full},  {"transparency", transparency},
    {"delay", delay_map},
};

// H2 and H3 are one run each of the same comparison.
std::string canonical(const std::string& name) {
  return name == "h3" ? "h2" : name;
}

std::vector<Experiment> run_named(const std::string& name) {
  std::vector<Experiment> out;
  for (const Named& e : kExperiments)
    if (name == "all" || canonical(name) == e.name) out.push_back(e.run());
  if (out.empty())
    throw std::runtime_error("there is no experiment '" + name +
                             "': give f1, f2, h1, h2, h3, pareto, transparency, delay or all");
  return out;
}

std::string number(double x) {
  return std::isfinite(x) ? fmt::format("{:.4g}", x) : "";
}

std::string wanted(const Figure& f) {
  if (!f.judged()) return "";
  if (f.low == f.high) return number(f.low);
  if (!std::isfinite(f.low) || (f.low == 0 && std::isfinite(f.high)))
    return "at most " + number(f.high);
  if (!std::isfinite(f.high)) return "at least " + number(f.low);
  return number(f.low) + " to " + number(f.high);
}

std::string verdict(const Figure& f) {
  if (!f.judged()) return "";
  return f.good() ? "pass" : "FAIL";
}

void print(const Table& t) {
  std::printf("  %s\n  %-40s", t.caption.c_str(), "");
  for (const std::string& h : t.headings) std::printf(" %14s", h.c_str());
  for (const TableRow& row : t.rows) {
    std::printf("\n  %-40s", row.label.c_str());
    for (const std::string& cell : row.cells) std::printf(" %14s", cell.c_str());
  }
  std::printf("\n");
}

void print(const Experiment& e) {
  std::printf("%s\n  %s\n", e.title.c_str(), e.about.c_str());
  std::printf("  %-58s %-6s %16s %10s %10s %16s\n", "", "", "published", "reference", "ours",
              "accepted");
  for (const Figure& f : e.figures)
    std::printf("  %-58s %-6s %16s %10s %10s %16s  %s\n", f.what.c_str(), f.unit.c_str(),
                f.published.c_str(), number(f.reference).c_str(), number(f.ours).c_str(),
                wanted(f).c_str(), verdict(f).c_str());
  for (const Table& t : e.tables) print(t);
  std::printf("\n");
}

nlohmann::json to_json(const std::vector<Experiment>& experiments) {
  nlohmann::json out = nlohmann::json::array();
  for (const Experiment& e : experiments)
    for (const Figure& f : e.figures)
      out.push_back({{"experiment", e.title},
                     {"figure", f.what},
                     {"unit", f.unit},
                     {"ours", f.ours},
                     {"reference",
                      std::isfinite(f.reference) ? nlohmann::json(f.reference) : nlohmann::json()},
                     {"good", f.judged() ? nlohmann::json(f.good()) : nlohmann::json()}});
  return out;
}

Table table(const Experiment& e) {
  Table t{.caption = e.title,
          .blocks = {""},
          .headings = {"published", "reference", "ours", "accepted", "verdict"}};
  for (const Figure& f : e.figures)
    t.rows.push_back({f.what,
                      f.unit,
                      {f.published, number(f.reference), number(f.ours), wanted(f), verdict(f)}});
  return t;
}

void write_page(std::vector<Experiment> experiments, const std::string& path) {
  Page page{.title = "The publications' experiments",
            .facts = {"Published value, the reference simulation's, and this build's; simulated, "
                      "with the product's own controllers."}};
  for (Experiment& e : experiments) {
    fit_axes(e.charts);
    e.tables.insert(e.tables.begin(), table(e));
    page.rows.push_back({e.title, e.about, e.charts, e.tables});
  }
  std::ofstream out(path, std::ios::binary);
  out << html(page) << std::flush;
  if (!out) throw std::runtime_error(path + " cannot be written: choose another place");
}

}  // namespace

int run_experiments(const ExperimentOptions& options) {
  const std::vector<Experiment> experiments = run_named(options.name);
  bool good = true;
  for (const Experiment& e : experiments) {
    for (const Figure& f : e.figures) good &= f.good();
    if (!options.json) print(e);
  }
  if (options.json) {
    std::printf("%s\n", to_json(experiments).dump(2).c_str());
  } else {
    write_page(experiments, options.page);
    std::printf("pictures: %s\n", options.page.c_str());
  }
  return good ? 0 : 1;
}

}  // namespace farhand
