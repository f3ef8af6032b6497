// A row of bench.json, and what may be said of rows: which of a rival's points ours does not cover,
// and what became slower or less accurate between two files.
#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace farhand::bench {

inline constexpr const char* kOurs = "Farhand";  // contenders whose name begins so are ours
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Times within this share of each other are equal, errors within this factor: the spread of medians
// on a quiet machine, and of worst roundings over other inputs.
inline constexpr double kTimeNoise = 0.05, kErrorNoise = 1.5;
// Between two runs the machine itself changes: what differs by less is not told.
inline constexpr double kRunNoise = 0.15;

struct Result {
  std::string subject, contender, set, parameter, time_of, unit, note;
  double time_ns = kNone, time_low_ns = kNone, time_high_ns = kNone;
  double error = kNone, error_worst = kNone;
  double target_ns = kNone, instructions = kNone;  // kNone: there is none
  std::size_t repetitions = 0, inputs = 0;

  bool ours() const { return contender.starts_with(kOurs); }
  std::string key() const { return subject + '|' + contender + '|' + set + '|' + parameter; }
};
std::vector<Result> results(const nlohmann::json& rows);

// A point of a rival's curve that lies below ours: no point of ours is as fast and as accurate, in
// 99 of 100 inputs and in the worst.
struct Uncovered {
  Result rival;
  double our_time_ns = kNone;  // of our fastest as accurate as the rival; kNone: none is
  double our_error = kNone, our_worst = kNone;  // the least of ours
};
std::vector<Uncovered> uncovered(const std::vector<Result>& all);

// The same by curve: how many of a rival's points on a set, and the fastest of them.
struct Better {
  Uncovered fastest;
  std::size_t points = 0, of = 0;
};
std::vector<Better> where_rivals_are_better(const std::vector<Result>& all);

struct Change {
  Result before, after;
  double time_ratio = 1;  // after / before, less what the machine changed
  bool slower = false, less_accurate = false;
};
struct Comparison {
  // Median ratio of the rivals' times: what the machine changed. Taken out subject by subject,
  // since it changes within a run too; this is that of all, for subjects without rivals.
  double machine = 1;
  std::vector<Change> changes;
  std::vector<std::string> gone;  // keys that only the older has
};
Comparison compare(const std::vector<Result>& before, const std::vector<Result>& after);

}  // namespace farhand::bench
