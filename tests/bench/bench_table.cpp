#include "tests/bench/bench_table.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>

namespace farhand::bench {
namespace {

using Json = nlohmann::json;

// Between these two fractions of the repetitions lies the spread that a row states.
constexpr double kLow = 0.25, kHigh = 0.75;

double quantile(const std::vector<double>& sorted, double fraction) {
  return sorted[static_cast<std::size_t>(
      std::lround(fraction * static_cast<double>(sorted.size() - 1)))];
}

double load() {
  double now = 0;
  std::ifstream("/proc/loadavg") >> now;
  return now;
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

// CPU time of every repetition [ns per call], by benchmark.
class Times : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration)
        of[run.run_name.function_name].push_back(run.cpu_accumulated_time * 1e9 /
                                                 static_cast<double>(run.iterations));
    std::cerr << '.' << std::flush;
  }
  std::map<std::string, std::vector<double>> of;
};

// JSON has no infinity: a contender that never answers has the largest error there is.
Json number(double x) {
  if (std::isnan(x)) return nullptr;
  return std::min(x, std::numeric_limits<double>::max());
}

Json to_json(const Row& row, const std::vector<double>& times, const std::string& time_of) {
  return {{"subject", row.label.subject},
          {"contender", row.label.contender},
          {"set", row.label.set},
          {"parameter", row.label.parameter},
          {"time_ns", quantile(times, 0.5)},
          {"time_low_ns", quantile(times, kLow)},
          {"time_high_ns", quantile(times, kHigh)},
          {"time_of", time_of},
          {"repetitions", times.size()},
          {"error", number(row.error.usual)},
          {"error_worst", number(row.error.worst)},
          {"unit", row.error.unit},
          {"inputs", row.error.inputs},
          {"note", row.error.note},
          {"target_ns", number(row.target_ns)}};
}

}  // namespace

Accuracy accuracy(std::vector<double> errors, std::string unit, std::string note) {
  for (double& e : errors)
    if (std::isnan(e)) e = std::numeric_limits<double>::infinity();
  std::sort(errors.begin(), errors.end());
  const auto last = static_cast<double>(errors.size() - 1);
  return {.usual = errors[static_cast<std::size_t>(std::ceil(0.99 * last))],
          .worst = errors.back(),
          .unit = std::move(unit),
          .inputs = errors.size(),
          .note = std::move(note)};
}

Table::Table(int argc, char** argv) : load_before_(load()) {
  arguments_.emplace_back(argv[0]);
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    if (flag == "--quick")
      quick_ = true;
    else if (flag == "--long")
      long_ = true;
    else if (flag == "--out" && i + 1 < argc)
      out_ = argv[++i];
    else
      arguments_.push_back(flag);
  }
  arguments_.emplace_back("--benchmark_enable_random_interleaving=true");
}

std::string Table::add(std::vector<Row> rows, double per_call, const char* time_of) {
  const Label& l = rows.front().label;
  std::string name = l.subject + '|' + l.contender + '|' + l.set + '|' + l.parameter;
  std::replace(name.begin(), name.end(), '/', ' ');  // Google Benchmark splits names there
  timed_.push_back({std::move(rows), per_call, time_of});
  char number[10];  // in front, so that names sort in order of registration
  std::snprintf(number, sizeof number, "%04zu|", timed_.size() - 1);
  return number + name;
}

void Table::prepare(benchmark::internal::Benchmark* b) const {
  b->MinTime(quick_ ? 0.001 : 0.01)->Repetitions(quick_ ? 3 : 15);
}

int Table::finish() {
  std::vector<char*> arguments;
  for (std::string& a : arguments_) arguments.push_back(a.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  Times times;
  benchmark::RunSpecifiedBenchmarks(&times);
  std::cerr << '\n';

  Json rows = Json::array();
  for (const auto& [name, measured] : times.of) {
    const Timed& timed = timed_[std::stoul(name)];
    std::vector<double> sorted;
    for (const double t : measured) sorted.push_back(t / timed.per_call);
    std::sort(sorted.begin(), sorted.end());
    for (const Row& row : timed.rows) rows.push_back(to_json(row, sorted, timed.time_of));
  }
  const Json machine = {{"processor", processor()},
                        {"load_before", load_before_},
                        {"load_after", load()},
                        {"compiler", __VERSION__},
                        {"quick", quick_}};
  std::ofstream(out_) << Json{{"machine", machine}, {"rows", rows}}.dump(1) << '\n';
  return 0;
}

}  // namespace farhand::bench
