#include "tests/bench/result.hpp"

#include <algorithm>
#include <map>

namespace farhand::bench {
namespace {

double number(const nlohmann::json& row, const char* name) {
  return row.contains(name) && row[name].is_number() ? row[name].get<double>() : kNone;
}

bool as_accurate(const Result& a, const Result& b) {
  return a.error <= kErrorNoise * b.error && a.error_worst <= kErrorNoise * b.error_worst;
}
bool as_fast(const Result& a, const Result& b) {
  return a.time_ns <= (1 + kTimeNoise) * b.time_ns;
}

double median(std::vector<double> x) {
  if (x.empty()) return 1;
  std::nth_element(x.begin(), x.begin() + static_cast<long>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

Change change(const Result& before, const Result& after, double machine) {
  Change c{.before = before, .after = after};
  c.time_ratio = after.time_ns / before.time_ns / machine;
  c.slower = c.time_ratio > 1 + kRunNoise && after.time_low_ns > before.time_high_ns * machine;
  c.less_accurate = after.error > kErrorNoise * before.error ||
                    after.error_worst > kErrorNoise * before.error_worst;
  return c;
}

}  // namespace

std::vector<Result> results(const nlohmann::json& rows) {
  std::vector<Result> out;
  for (const nlohmann::json& r : rows)
    out.push_back({.subject = r.at("subject"),
                   .contender = r.at("contender"),
                   .set = r.at("set"),
                   .parameter = r.at("parameter"),
                   .time_of = r.at("time_of"),
                   .unit = r.at("unit"),
                   .note = r.at("note"),
                   .time_ns = number(r, "time_ns"),
                   .time_low_ns = number(r, "time_low_ns"),
                   .time_high_ns = number(r, "time_high_ns"),
                   .error = number(r, "error"),
                   .error_worst = number(r, "error_worst"),
                   .target_ns = number(r, "target_ns"),
                   .instructions = number(r, "instructions"),
                   .repetitions = r.at("repetitions"),
                   .inputs = r.at("inputs")});
  return out;
}

std::vector<Uncovered> uncovered(const std::vector<Result>& all) {
  std::map<std::string, std::vector<const Result*>> ours;
  for (const Result& r : all)
    if (r.ours()) ours[r.subject + '|' + r.set].push_back(&r);
  std::vector<Uncovered> out;
  for (const Result& rival : all) {
    const auto found = ours.find(rival.subject + '|' + rival.set);
    if (rival.ours() || found == ours.end()) continue;
    // Without errors only time counts.
    Uncovered u{.rival = rival};
    bool covered = false;
    for (const Result* our : found->second) {
      u.our_error = std::fmin(u.our_error, our->error);
      u.our_worst = std::fmin(u.our_worst, our->error_worst);
      if (!std::isnan(rival.error) && !as_accurate(*our, rival)) continue;
      u.our_time_ns = std::fmin(u.our_time_ns, our->time_ns);
      covered = covered || as_fast(*our, rival);
    }
    if (!covered) out.push_back(u);
  }
  return out;
}

std::vector<Better> where_rivals_are_better(const std::vector<Result>& all) {
  const auto curve = [](const Result& r) { return r.subject + '|' + r.set + '|' + r.contender; };
  std::vector<Better> out;
  for (const Uncovered& u : uncovered(all)) {
    const auto known = std::find_if(out.begin(), out.end(), [&](const Better& b) {
      return curve(b.fastest.rival) == curve(u.rival);
    });
    Better& b = known == out.end() ? out.emplace_back(Better{.fastest = u}) : *known;
    ++b.points;
    if (u.rival.time_ns < b.fastest.rival.time_ns) b.fastest = u;
  }
  for (Better& b : out)
    b.of = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const Result& r) {
      return curve(r) == curve(b.fastest.rival);
    }));
  return out;
}

Comparison compare(const std::vector<Result>& before, const std::vector<Result>& after) {
  std::map<std::string, const Result*> now;
  for (const Result& r : after) now[r.key()] = &r;
  Comparison out;
  std::vector<double> rivals;
  std::map<std::string, std::vector<double>> rivals_of;
  for (const Result& r : before) {
    const auto found = now.find(r.key());
    if (found == now.end()) {
      out.gone.push_back(r.key());
    } else if (!r.ours()) {
      rivals.push_back(found->second->time_ns / r.time_ns);
      rivals_of[r.subject].push_back(rivals.back());
    }
  }
  out.machine = median(rivals);
  for (const Result& r : before) {
    const auto found = now.find(r.key());
    if (found == now.end()) continue;
    const auto same_subject = rivals_of.find(r.subject);
    const double machine =
        same_subject == rivals_of.end() ? out.machine : median(same_subject->second);
    out.changes.push_back(change(r, *found->second, machine));
  }
  return out;
}

}  // namespace farhand::bench
