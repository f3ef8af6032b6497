// bench-report --out FOLDER [--fact TEXT]... FILE...   the programs' rows to bench.json, bench.html
// bench-report --compare OLD NEW                       what became slower or less accurate
//
// A FILE has rows, or counts of instructions that belong to rows. --compare exits with 1 if
// anything of ours is flagged.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "common/program.hpp"
#include "tests/bench/bench_page.hpp"

namespace farhand::bench {
namespace {

using Json = nlohmann::json;

Json read(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path);
  return Json::parse(in);
}

void put_instructions(Json& rows, const Json& counts) {
  for (const Json& c : counts)
    for (Json& row : rows)
      if (row["subject"] == c.at("subject") && row["contender"] == c.at("contender") &&
          row["set"] == c.at("set"))
        row["instructions"] = c.at("instructions");
}

void print(const std::vector<Result>& all) {
  std::puts("targets");
  for (const Result& r : all)
    if (!std::isnan(r.target_ns))
      std::printf("  %-24s %-28s %9s [%s] %s\n", r.subject.c_str(), r.set.c_str(),
                  time_text(r.time_ns).c_str(), time_text(r.target_ns).c_str(),
                  r.time_ns <= r.target_ns ? "met" : "MISSED");
  std::puts(
      "where rivals are better: points; of the fastest time, error and worst; our time for it");
  for (const Better& b : where_rivals_are_better(all)) {
    const Result& r = b.fastest.rival;
    std::printf("  %-22s %-32s %-25s %2zu of %zu %9s %8s %8s | %9s, ours %s %s\n",
                r.subject.c_str(), r.set.c_str(), r.contender.c_str(), b.points, b.of,
                time_text(r.time_ns).c_str(), error_text(r.error).c_str(),
                error_text(r.error_worst).c_str(),
                time_text_or_never(b.fastest.our_time_ns).c_str(),
                error_text(b.fastest.our_error).c_str(), error_text(b.fastest.our_worst).c_str());
  }
}

int collect(const std::filesystem::path& folder, Json facts,
            const std::vector<std::string>& files) {
  Json all{{"machine", Json::array()}, {"rows", Json::array()}};
  Json counts = Json::array();
  for (const std::string& file : files) {
    const Json part = read(file);
    if (part.contains("instructions")) {
      counts = part["instructions"];
      continue;
    }
    all["machine"].push_back(part.at("machine"));
    for (const Json& row : part.at("rows")) all["rows"].push_back(row);
  }
  put_instructions(all["rows"], counts);
  double least = 1e9, most = 0;
  for (const Json& m : all["machine"])
    for (const char* when : {"load_before", "load_after"})
      least = std::min(least, m.at(when).get<double>()),
      most = std::max(most, m[when].get<double>());
  char load[120];
  std::snprintf(load, sizeof load, "load of the machine %.1f to %.1f, ours of 1 included", least,
                most);
  facts.push_back(load);
  for (const Json& m : all["machine"])
    if (m.at("quick").get<bool>()) {
      facts.push_back("A quick run: few inputs and repetitions, nothing to rely on.");
      break;
    }
  if (!all["machine"].empty())
    facts.push_back("processor " + all["machine"][0].at("processor").get<std::string>() + ", g++ " +
                    all["machine"][0].at("compiler").get<std::string>());
  facts.push_back(
      "Times: median and quartiles of the CPU time per call over all repetitions, rivals "
      "interleaved at random, inputs in turn from one shuffled set for all. Errors: 99 of 100 "
      "inputs are no worse, and the worst.");
  all["facts"] = facts;
  std::ofstream(folder / "bench.json") << all.dump(1) << '\n';
  const std::vector<Result> rows = results(all["rows"]);
  std::ofstream(folder / "bench.html") << bench_page(rows, facts);
  print(rows);
  return 0;
}

int compare_files(const std::string& before, const std::string& after) {
  const Comparison c = compare(results(read(before).at("rows")), results(read(after).at("rows")));
  std::printf(
      "%zu rows; the machine made the rivals' times %.3f of what they were in the median (taken "
      "out by subject)\n",
      c.changes.size(), c.machine);
  std::printf("flagged: slower by more than %.0f %% with quartiles apart, or error %.1f times\n",
              100 * kRunNoise, kErrorNoise);
  int flagged = 0;
  for (const Change& x : c.changes) {
    if (!x.slower && !x.less_accurate) continue;
    flagged += x.after.ours() ? 1 : 0;
    std::printf("  %-70s time %9s -> %9s (%.2f)  error %8s -> %8s %s%s\n", x.after.key().c_str(),
                time_text(x.before.time_ns).c_str(), time_text(x.after.time_ns).c_str(),
                x.time_ratio, error_text(x.before.error).c_str(), error_text(x.after.error).c_str(),
                x.slower ? "SLOWER " : "", x.less_accurate ? "LESS ACCURATE" : "");
  }
  for (const std::string& key : c.gone) std::printf("  gone: %s\n", key.c_str());
  std::printf("%d of ours flagged\n", flagged);
  return flagged > 0 ? 1 : 0;
}

int run(int argc, char** argv) {
  const std::vector<std::string> a(argv + 1, argv + argc);
  if (a.size() == 3 && a[0] == "--compare") return compare_files(a[1], a[2]);
  std::string folder;
  Json facts = Json::array();
  std::vector<std::string> files;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == "--out" && i + 1 < a.size())
      folder = a[++i];
    else if (a[i] == "--fact" && i + 1 < a.size())
      facts.push_back(a[++i]);
    else
      files.push_back(a[i]);
  }
  if (folder.empty() || files.empty()) {
    std::puts(
        "usage: bench-report --out FOLDER [--fact TEXT]... FILE...\n"
        "       bench-report --compare OLD NEW");
    return 2;
  }
  return collect(folder, facts, files);
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  return farhand::run_guarded("bench-report", [&] { return farhand::bench::run(argc, argv); });
}
