#include "common/report/report.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "common/report/charts.hpp"
#include "common/report/run_summary.hpp"
#include "common/scene.hpp"

namespace farhand {
namespace {

std::string stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

std::string own(const RunData& run, const std::string& key) {
  const auto map = run.metadata.find("farhand");
  if (map == run.metadata.end()) return {};
  const auto it = map->second.find(key);
  return it == map->second.end() ? std::string() : it->second;
}

std::string scene_title(const RunData& run) {
  std::string title = stem(run.scene_path);
  if (!run.scene_text.empty()) try {
      const std::string about = parse_scene(run.scene_text, run.scene_path).proto.description();
      if (!about.empty()) title += ": " + about;
    } catch (const SceneError&) {
      // Of another version: its name is enough.
    }
  return title.empty() ? "a run without a scene" : title;
}

// Virtual time starts near 0 and is no date.
std::string date_of(const RunData& run) {
  constexpr std::int64_t kYear2000 = 946684800;
  const std::int64_t s = run.start_ns() / 1'000'000'000;
  if (s < kYear2000) return "virtual time";
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(static_cast<std::time_t>(s)));
}

std::string fact(const RunData& run, const std::string& name) {
  std::string out = name.empty() ? "" : name + ": ";
  out += date_of(run);
  static constexpr const char* kBuild[][2] = {{"version", "version "},
                                              {"git_revision", "revision "},
                                              {"compiler", ""},
                                              {"flags", ""},
                                              {"seed", "seed "}};
  for (const auto& [key, prefix] : kBuild)
    if (const std::string value = own(run, key); !value.empty()) out += "; " + (prefix + value);
  out += "; ";
  for (std::size_t i = 0; i < run.files.size(); ++i) out += (i > 0 ? ", " : "") + run.files[i];
  return out;
}

std::string title(const std::vector<RunData>& runs) {
  std::vector<std::string> titles;
  for (const RunData& run : runs)
    if (const std::string t = scene_title(run);
        std::find(titles.begin(), titles.end(), t) == titles.end())
      titles.push_back(t);
  return fmt::format("{}", fmt::join(titles, " | "));
}

}  // namespace

std::vector<std::string> names_of(const std::vector<RunData>& runs) {
  std::vector<std::string> names;
  for (const RunData& run : runs) {
    names.push_back(run.files.empty() ? "run" : stem(run.files.front()));
    // Two of one name in different folders: say the folder.
    if (std::count(names.begin(), names.end(), names.back()) > 1) names.back() = run.files.front();
  }
  return names;
}

std::string report_html(const std::vector<RunData>& runs) {
  const std::vector<std::string> names = names_of(runs);
  Page page{.title = title(runs)};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    page.facts.push_back(fact(runs[i], runs.size() > 1 ? names[i] : ""));
    page.warnings.insert(page.warnings.end(), runs[i].notes.begin(), runs[i].notes.end());
  }
  page.tables = tables(summarize(runs), names);
  page.before_charts = strip_key();
  page.rows = chart_rows(views(runs, names));
  return html(page);
}

std::string report_json(const std::vector<RunData>& runs) {
  return json(summarize(runs), runs, names_of(runs));
}

}  // namespace farhand
