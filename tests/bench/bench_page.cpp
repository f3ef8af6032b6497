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

Table where_rivals_win(const std::vector<Better>& better) {
  Table t{.caption = "Where rivals are better: nothing of ours is as fast and as accurate",
          .blocks = {""},
          .headings = {"fastest", "99 %", "worst", "ours for it", "our 99 %", "our worst"}};
  for (const Better& b : better) {
    const auto& [rival, our_time, our_error, our_worst] = b.fastest;
    t.rows.push_back(
        {joined({rival.subject, rival.set, rival.contender,
                 fmt::format("{} of {} points", b.points, b.of)}),
         rival.unit,
         {time_text(rival.time_ns), error_text(rival.error), error_text(rival.error_worst),
          time_text_or_never(our_time), error_text(our_error), error_text(our_worst)}});
  }
  return t;
}

Table figures(const std::vector<Result>& of_set) {
  const Result& first = of_set.front();
  Table t{.caption = fmt::format("{}: time of a {}, error{}", first.set, first.time_of,
                                 first.unit.empty() ? "" : " [" + first.unit + "]"),
          .blocks = {""},
          .headings = {"median", "spread", "99 %", "worst"}};
  const bool counted = std::any_of(of_set.begin(), of_set.end(),
                                   [](const Result& r) { return !std::isnan(r.instructions); });
  if (counted) t.headings.push_back("instructions");
  for (const Result& r : of_set) {
    const double spread = (r.time_high_ns - r.time_low_ns) / 2 / r.time_ns;
    t.rows.push_back({joined({r.contender, r.parameter, r.note}),
                      "",
                      {time_text(r.time_ns), fmt::format("\u00b1{:.0f} %", 100 * spread),
                       error_text(r.error), error_text(r.error_worst)}});
    if (counted)
      t.rows.back().cells.push_back(
          std::isnan(r.instructions) ? "" : fmt::format("{:.0f}", r.instructions));
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
              .width = 1100,
              .panel_height = 190};
  const std::vector<std::string> contenders = contenders_of(of_subject);
  for (const std::string& set : names(of_subject, &Result::set))
    if (Panel panel = picture(only(of_subject, &Result::set, set), contenders);
        !panel.lines.empty())
      chart.panels.push_back(std::move(panel));
  if (chart.panels.size() > 1) chart.columns = 2;
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

std::string time_text_or_never(double ns) {
  return std::isnan(ns) ? "never" : time_text(ns);
}

std::string bench_page(const std::vector<Result>& all, const std::vector<std::string>& facts) {
  const std::vector<Better> better = where_rivals_are_better(all);
  Page page{.title = "Farhand: run time against error", .facts = facts};
  if (!better.empty())
    page.warnings.push_back(fmt::format(
        "{} curves of rivals lie below ours somewhere: see the second table.", better.size()));
  page.tables = {acceptance(all), where_rivals_win(better)};
  for (const std::string& subject : names(all, &Result::subject)) {
    const std::vector<Result> of_subject = only(all, &Result::subject, subject);
    ChartRow row{.heading = subject};
    for (const std::string& set : names(of_subject, &Result::set))
      row.tables.push_back(figures(only(of_subject, &Result::set, set)));
    if (Chart chart = pictures(of_subject); !chart.panels.empty()) row.charts = {std::move(chart)};
    fit_axes(row.charts);
    page.rows.push_back(std::move(row));
  }
  return html(page);
}

}  // namespace farhand::bench
