// farhand-report RUN.mcap... [-o report.html] [--json]
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "common/arguments.hpp"
#include "common/program.hpp"
#include "common/report/merge.hpp"
#include "common/report/report.hpp"
#include "common/report/run_file.hpp"

namespace {

constexpr std::size_t kMostRuns = 4;

// A bar on a terminal; nothing in a pipe.
void show_progress(const std::string& path, double share) {
  if (isatty(STDERR_FILENO) == 0) return;
  constexpr int kWidth = 30;
  const int done = static_cast<int>(share * kWidth);
  std::fprintf(stderr, "\r%s [%s%s] %3.0f %%%s", path.c_str(), std::string(done, '=').c_str(),
               std::string(kWidth - done, ' ').c_str(), share * 100, share < 1 ? "" : "\n");
}

std::vector<farhand::RunData> read_all(const std::vector<std::string>& files) {
  std::vector<farhand::RunData> runs;
  for (const std::string& file : files)
    runs.push_back(farhand::read_run(file, [&](double share) { show_progress(file, share); }));
  return farhand::merge_runs(std::move(runs));
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << std::flush;
  if (!out) throw std::runtime_error(path + " cannot be written: choose another place with -o");
}

int report(const std::vector<std::string>& files, const std::string& output, bool json) {
  const std::vector<farhand::RunData> runs = read_all(files);
  if (runs.size() > kMostRuns)
    throw std::runtime_error("more than 4 runs do not fit side by side: give fewer files");
  if (json) std::fputs(farhand::report_json(runs).c_str(), stdout);
  if (json && output.empty()) return 0;
  const std::string path = output.empty() ? "report.html" : output;
  write_file(path, farhand::report_html(runs));
  std::fprintf(stderr, "farhand-report: wrote %s\n", path.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  farhand::Arguments arguments("One page about recorded runs: figures and charts",
                               "farhand-report");
  std::vector<std::string> files;
  std::string output;
  bool json = false;
  arguments.option("recording", files,
                   "files written with --record; a master's and a slave's of one run become one");
  arguments.option("-o,--output", output, "the page, report.html unless --json");
  arguments.flag("--json", json, "the figures as JSON to stdout, SI units; a page only with -o");
  const auto missing = [&] { return files.empty() ? "recording" : ""; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  return farhand::run_guarded("farhand-report", [&] { return report(files, output, json); });
}
