#include "tests/bench/bench_page.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/report/html_page.hpp"

namespace farhand::bench {
namespace {

constexpr double kExact = 1e-20;  // where an error of zero is drawn

// The distinct values of a member in order of appearance.
std::vector<std::string> names(const std::vector<Result>& all, std::string Result::*member) {
  std::vector<std::string> out;
  for (const Result& r : all)
    if (std::find(out.begin(), out.end(), r.*member) == out.end()) out.push_back(r.*member);
  return out;
}
std::vector<Result> only(const std::vector<Result>& all, std::string Result::*member,
                         const std::string& value) {
  std::vector<Result> out;
  for (const Result& r : all)
    if (r.*member == value) out.push_back(r);
  return out;
}

std::string joined(std::initializer_list<std::string> parts) {
  std::string out;
  for (const std::string& part : parts)
    if (!part.empty()) out += (out.empty() ? "" : ", ") + part;
  return out;
}

Table acceptance(const std::vector<Result>& all) {
  Table t{.caption = "Targets", .blocks = {""}, .headings = {"median", "target", ""}};
  for (const Result& r : all)
    if (!std::isnan(r.target_ns))
      t.rows.push_back({joined({r.subject, r.set, r.parameter}),
                        "",
                        {time_text(r.time_ns), time_text(r.target_ns),
                         r.time_ns <= r.target_ns ? "met" : "MISSED"}});
  return t;
}

Table where_rivals_win(const std::vector<Uncovered>& points) {
  Table t{.caption = "Where a rival is better: nothing of ours is as fast and as accurate",
          .blocks = {""},
          .headings = {"its time", "its error", "our time for it", "our error"}};
  for (const Uncovered& u : points)
    t.rows.push_back({joined({u.rival.subject, u.rival.set, u.rival.contender, u.rival.parameter}),
                      u.rival.unit,
                      {time_text(u.rival.time_ns), error_text(u.rival.error),
                       std::isnan(u.our_time_ns) ? "never" : time_text(u.our_time_ns),
                       error_text(u.our_error)}});
  return t;
}

Table figures(const std::vector<Result>& of_set) {
  const Result& first = of_set.front();
  Table t{.caption = fmt::format("{}, {}: time of a {}", first.subject, first.set, first.time_of),
          .blocks = {""},
          .headings = {"median", "quartiles", "error", "worst"}};
  const bool counted = std::any_of(of_set.begin(), of_set.end(),
                                   [](const Result& r) { return !std::isnan(r.instructions); });
  if (counted) t.headings.push_back("instructions");
  for (const Result& r : of_set) {
    t.rows.push_back({joined({r.contender, r.parameter, r.note}),
                      r.unit,
                      {time_text(r.time_ns),
                       fmt::format("{} .. {}", time_text(r.time_low_ns), time_text(r.time_high_ns)),
                       error_text(r.error), error_text(r.error_worst)}});
    if (counted) t.rows.back().cells.push_back(fmt::format("{:.0f}", r.instructions));
  }
  return t;
}

bool drawable(const Result& r) {
  return r.error >= 0 && r.error < 1e6 && r.unit != "accepted";
}

Panel picture(const std::vector<Result>& of_set, const std::vector<std::string>& contenders) {
  Panel panel{.x = {.label = "time [ns]", .log = true},
              .y = {.label = fmt::format("error [{}]", of_set.front().unit), .log = true},
              .note = of_set.front().set};
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    Line line{.name = contenders[i], .style = static_cast<int>(i) % kLineStyles, .markers = true};
    for (const Result& r : only(of_set, &Result::contender, contenders[i]))
      if (drawable(r)) line.points.push_back({r.time_ns, std::max(r.error, kExact)});
    std::sort(line.points.begin(), line.points.end(),
              [](const Point& a, const Point& b) { return a.x < b.x; });
    if (!line.points.empty()) panel.lines.push_back(line);
  }
  return panel;
}

// Ours first, so that it has the same style everywhere.
std::vector<std::string> contenders_of(const std::vector<Result>& of_subject) {
  std::vector<std::string> out = names(of_subject, &Result::contender);
  std::stable_partition(out.begin(), out.end(),
                        [](const std::string& c) { return c.starts_with(kOurs); });
  return out;
}

Chart pictures(const std::vector<Result>& of_subject) {
  Chart chart{.title = of_subject.front().subject,
              .subtitle = "run time and error, lower left is better",
              .columns = 2,
              .width = 1100,
              .panel_height = 190};
  const std::vector<std::string> contenders = contenders_of(of_subject);
  for (const std::string& set : names(of_subject, &Result::set))
    if (Panel panel = picture(only(of_subject, &Result::set, set), contenders);
        !panel.lines.empty())
      chart.panels.push_back(std::move(panel));
  return chart;
}

}  // namespace

std::string time_text(double ns) {
  if (std::isnan(ns)) return "";
  if (ns < 1e3) return fmt::format("{:.3g} ns", ns);
  if (ns < 1e6) return fmt::format("{:.3g} us", ns / 1e3);
  return fmt::format("{:.3g} ms", ns / 1e6);
}
std::string error_text(double error) {
  if (std::isnan(error)) return "";
  if (error > 1e300) return "none";
  return error == 0 ? "0" : fmt::format("{:.1e}", error);
}

std::string bench_page(const std::vector<Result>& all, const std::vector<std::string>& facts) {
  const std::vector<Uncovered> better = uncovered(all);
  Page page{.title = "Farhand: run time against error", .facts = facts};
  if (!better.empty())
    page.warnings.push_back(fmt::format(
        "{} points of rivals lie below our curves: see the second table.", better.size()));
  page.tables = {acceptance(all), where_rivals_win(better)};
  for (const std::string& subject : names(all, &Result::subject)) {
    const std::vector<Result> of_subject = only(all, &Result::subject, subject);
    for (const std::string& set : names(of_subject, &Result::set))
      page.tables.push_back(figures(only(of_subject, &Result::set, set)));
    ChartRow row{.heading = subject, .charts = {pictures(of_subject)}};
    if (row.charts[0].panels.empty()) continue;
    fit_axes(row.charts);
    page.rows.push_back(std::move(row));
  }
  return html(page);
}

}  // namespace farhand::bench
