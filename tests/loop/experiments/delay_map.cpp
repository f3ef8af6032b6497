// A wall pressed over networks of growing delay, by the compensations that know no more of the
// world than they find out: what is felt of it, and what moving freely costs.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>

#include "tests/loop/experiments/experiment.hpp"
#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

constexpr std::array kRoundTrips = {2., 20., 50., 100., 200., 400.};  // [ms]
constexpr std::array kWalls = {200., 1000., 5000.};                   // [N/m]
constexpr double kHeld = 6;                                           // [s]
constexpr double kStill = 0.005;  // [m/s] rms of a handle that does not chatter

struct Compensated {
  const char* name;
  void (*set)(proto::Compensation&);
};
constexpr std::array kCompensations = {
    Compensated{"none", nullptr},
    Compensated{"damped", [](proto::Compensation& c) { c.mutable_damped(); }},
    Compensated{"damped, touch",
                [](proto::Compensation& c) {
                  proto::DampedCompensation& d = *c.mutable_damped();
                  d.mutable_touch();
                  d.set_stiffness_newton_per_m(1500);
                  d.set_max_damping_newton_s_per_m(400);
                }},
    Compensated{"wave", [](proto::Compensation& c) { c.mutable_wave(); }},
    Compensated{"mmt", [](proto::Compensation& c) { c.mutable_mmt(); }},
    Compensated{"auto", [](proto::Compensation& c) { c.mutable_auto_(); }}};
static_assert(kCompensations.size() <= kLineStyles);

Pressing pressed_with(const Compensated& c, double rtt, double wall) {
  Scene scene = pressing_over(rtt, wall);
  scene.proto.clear_compensation();
  if (c.set != nullptr) c.set(*scene.proto.mutable_compensation());
  return pressed(scene, kHeld);
}

// Over the round trip; where the handle chatters there is no point.
struct Lines {
  Line felt, drag;
};

Lines of(std::size_t method, double wall, Table& table) {
  const Compensated& c = kCompensations[method];
  const Line empty{.name = c.name, .style = static_cast<int>(method), .markers = true};
  Lines out{empty, empty};
  TableRow row{.label = fmt::format("{:.0f} N/m, {}", wall, c.name)};
  for (const double rtt : kRoundTrips) {
    const Pressing p = pressed_with(c, rtt, wall);
    const bool still = p.chatter < kStill;
    row.cells.push_back(still ? fmt::format("{:.2f} / {:.1f}", p.stiffness / wall, p.drag) : "-");
    if (!still) continue;
    out.felt.points.push_back({rtt, p.stiffness / wall});
    out.drag.points.push_back({rtt, p.drag});
  }
  table.rows.push_back(std::move(row));
  return out;
}

Panel over_round_trip(std::string y) {
  return {.x = {.label = "round trip [ms]", .log = true}, .y = {.label = std::move(y), .lo = 0}};
}

}  // namespace

Experiment delay_map() {
  Experiment out{.title = "What is felt of a wall over a slow network",
                 .about =
                     "twin_delta and arm, free motion first, then pressed and held for 6 s; the "
                     "robot's wall is 200, 1000, 5000 N/m, the delay constant. Where the handle "
                     "moves by more than 5 mm/s rms there is no figure."};
  Table table{
      .caption = "felt of the wall's stiffness / mean drag of free motion [N], by round trip",
      .blocks = {""}};
  for (const double rtt : kRoundTrips) table.headings.push_back(fmt::format("{:.0f} ms", rtt));
  Chart chart{.title = "What is felt of a wall, and what free motion costs",
              .columns = static_cast<int>(kWalls.size()),
              .shared_x = false,
              .panel_height = 180};
  std::vector<Panel> drags;
  for (const double wall : kWalls) {
    Panel felt = over_round_trip(fmt::format("felt of {:.0f} N/m", wall)),
          drag = over_round_trip("drag [N]");
    for (std::size_t m = 0; m < kCompensations.size(); ++m) {
      Lines lines = of(m, wall, table);
      felt.lines.push_back(std::move(lines.felt));
      drag.lines.push_back(std::move(lines.drag));
    }
    chart.panels.push_back(std::move(felt));
    drags.push_back(std::move(drag));
  }
  for (Panel& p : drags) chart.panels.push_back(std::move(p));
  out.charts = {std::move(chart)};
  out.tables = {std::move(table)};
  return out;
}

}  // namespace farhand
