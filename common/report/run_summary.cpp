#include "common/report/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "common/limits.hpp"
#include "common/mode.hpp"
#include "common/report/statistics.hpp"
#include "common/statistics.hpp"

namespace farhand {
namespace {

using Values = std::vector<double>;
using OfRun = std::function<Values(const RunData&)>;
using OfMaster = std::function<Values(const MasterData&)>;
using OfSlave = std::function<Values(const SlaveData&)>;
using OfSide = std::function<Values(const SideData&)>;

OfRun at_master(OfMaster f) {
  return [f = std::move(f)](const RunData& r) { return r.master ? f(*r.master) : Values{}; };
}
OfRun at_slave(OfSlave f) {
  return [f = std::move(f)](const RunData& r) { return r.slave ? f(*r.slave) : Values{}; };
}

constexpr auto kEngaged = static_cast<std::uint8_t>(Mode::engaged);

enum class Touch { free, contact };

// Size of a - b on the hand's side while engaged, as the programs' own tables have it.
OfRun hand_error(const Columns<3> MasterData::*a, const Columns<3> MasterData::*b, Touch touch) {
  return at_master([=](const MasterData& m) {
    const Column force = length(m.environment_force);
    return error_figures(select(distance(m.*a, m.*b), [&](std::size_t i) {
      return m.mode[i] == kEngaged && (force[i] > kContactForce) == (touch == Touch::contact);
    }));
  });
}

OfRun tool_error(const Column SlaveData::*error, Touch touch) {
  return at_slave([=](const SlaveData& s) {
    const Column force = length(s.contact_force);
    return error_figures(select(s.*error, [&](std::size_t i) {
      return (force[i] > kContactForce) == (touch == Touch::contact);
    }));
  });
}

// Collects the rows of one group for all runs.
struct GroupBuilder {
  const std::vector<RunData>& runs;
  SummaryGroup group;

  void row(SummaryRow shape, const OfRun& f) {
    bool any = false;
    for (const RunData& run : runs) {
      shape.runs.push_back({f(run)});
      any = any || !shape.runs.back().values.empty();
    }
    if (any) group.rows.push_back(std::move(shape));
  }
};

GroupBuilder errors(const std::vector<RunData>& runs, std::string name) {
  return {runs, {std::move(name), {"rms", "99 %", "max"}, {"rms", "p99", "max"}, {}}};
}
GroupBuilder times(const std::vector<RunData>& runs, std::string name) {
  return {runs, {std::move(name), {"median", "99 %", "max"}, {"median", "p99", "max"}, {}}};
}
GroupBuilder singles(const std::vector<RunData>& runs, std::string name) {
  return {runs, {std::move(name), {""}, {"value"}, {}}};
}

SummaryGroup run_group(const std::vector<RunData>& runs) {
  GroupBuilder g = singles(runs, "Run");
  g.row({"duration_s", "duration", "s"}, [](const RunData& r) { return Values{r.duration()}; });
  const auto ticks = [](const SideData& d) { return Values{static_cast<double>(d.size())}; };
  g.row({"master_ticks", "ticks, master", "", 1, true}, at_master(ticks));
  g.row({"slave_ticks", "ticks, slave", "", 1, true}, at_slave(ticks));
  g.row({"coupled_ratio", "coupled", "%", 100}, at_slave([](const SlaveData& s) {
          const auto n = std::count(s.coupled.begin(), s.coupled.end(), 1);
          return Values{static_cast<double>(n) / static_cast<double>(s.size())};
        }));
  g.row({"contact_ratio", "in contact", "%", 100}, at_slave([](const SlaveData& s) {
          const Column f = length(s.contact_force);
          const auto n =
              std::count_if(f.begin(), f.end(), [](float x) { return x > kContactForce; });
          return Values{static_cast<double>(n) / static_cast<double>(s.size())};
        }));
  return g.group;
}

SummaryGroup tracking_group(const std::vector<RunData>& runs) {
  GroupBuilder g = errors(runs, "Tracking: robot against target, while coupled");
  g.row({"tracking_free_m", "position, free", "mm", 1e3},
        tool_error(&SlaveData::position_error, Touch::free));
  g.row({"tracking_contact_m", "position, in contact", "mm", 1e3},
        tool_error(&SlaveData::position_error, Touch::contact));
  g.row({"tracking_free_rad", "rotation, free", "mrad", 1e3},
        tool_error(&SlaveData::rotation_error, Touch::free));
  g.row({"tracking_contact_rad", "rotation, in contact", "mrad", 1e3},
        tool_error(&SlaveData::rotation_error, Touch::contact));
  g.row(
      {"position_control_m", "handle to set point", "mm", 1e3},
      at_master([](const MasterData& m) { return error_figures(distance(m.target, m.position)); }));
  return g.group;
}

SummaryGroup force_group(const std::vector<RunData>& runs) {
  GroupBuilder g = errors(runs, "Force: user's against environment's, while engaged");
  const auto row = [&](const char* key, const char* label, bool torque, Touch touch) {
    g.row({key, label, torque ? "mN m" : "N", torque ? 1e3 : 1},
          torque ? hand_error(&MasterData::user_torque, &MasterData::environment_torque, touch)
                 : hand_error(&MasterData::user_force, &MasterData::environment_force, touch));
  };
  row("force_error_free_n", "F_u \u2212 F_e, free", false, Touch::free);
  row("force_error_contact_n", "F_u \u2212 F_e, in contact", false, Touch::contact);
  row("torque_error_free_nm", "torque, free", true, Touch::free);
  row("torque_error_contact_nm", "torque, in contact", true, Touch::contact);
  g.row({"force_on_hand_n", "commanded on the hand", "N"}, at_master([](const MasterData& m) {
          return error_figures(
              select(length(m.force), [&](std::size_t i) { return m.mode[i] == kEngaged; }));
        }));
  g.row({"contact_force_n", "at the tool, in contact", "N"}, at_slave([](const SlaveData& s) {
          const Column f = length(s.contact_force);
          return error_figures(select(f, [&](std::size_t i) { return f[i] > kContactForce; }));
        }));
  return g.group;
}

SummaryGroup energy_group(const std::vector<RunData>& runs) {
  GroupBuilder g = singles(runs, "Energy");
  const auto last = [](const SideData& d) {
    return d.work.empty() ? Values{} : Values{d.work.back()};
  };
  g.row({"work_on_hand_j", "given to the hand", "mJ", 1e3}, at_master(last));
  g.row({"work_on_environment_j", "given to the environment", "mJ", 1e3}, at_slave(last));
  g.row({"generated_peak_j", "generated between, peak", "mJ", 1e3}, [](const RunData& r) {
    if (!r.master || !r.slave) return Values{};
    const Column e = generated_energy(*r.master, *r.slave);
    return e.empty() ? Values{} : Values{*std::max_element(e.begin(), e.end())};
  });
  return g.group;
}

std::vector<double> age_figures(const SideData& d) {
  Column us;
  us.reserve(d.size());
  for (const float s : d.age) us.push_back(s * 1e6f);
  return time_figures(us);
}

SummaryGroup link_group(const std::vector<RunData>& runs) {
  GroupBuilder g = times(runs, "Link");
  g.row({"round_trip_s", "round trip", "\u00b5s", 1e6},
        at_master([](const MasterData& m) { return time_figures(m.round_trip); }));
  g.row({"master_age_s", "age of data, master", "\u00b5s", 1e6}, at_master(age_figures));
  g.row({"slave_age_s", "age of data, slave", "\u00b5s", 1e6}, at_slave(age_figures));
  return g.group;
}

SummaryGroup losses_group(const std::vector<RunData>& runs) {
  GroupBuilder g = singles(runs, "Losses");
  g.row({"jitter_s", "jitter of the round trip", "\u00b5s", 1e6},
        at_master([](const MasterData& m) { return jitter(m.round_trip); }));
  struct Counter {
    const char *key, *label;
    std::uint64_t LinkTotals::*count;
  };
  static constexpr Counter kCounters[] = {{"lost", "lost", &LinkTotals::lost},
                                          {"dropped", "dropped", &LinkTotals::dropped},
                                          {"reordered", "reordered", &LinkTotals::reordered},
                                          {"not_sent", "not sent", &LinkTotals::not_sent}};
  for (const Counter& c : kCounters) {
    const auto value = [&](const SideData& d) {
      return Values{static_cast<double>(d.link.*c.count)};
    };
    g.row({std::string("master_") + c.key, std::string(c.label) + ", master", "", 1, true},
          at_master(value));
    g.row({std::string("slave_") + c.key, std::string(c.label) + ", slave", "", 1, true},
          at_slave(value));
  }
  return g.group;
}

std::string key_of(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

template <typename At>
void stage_rows(GroupBuilder& g, const char* side, const At& at) {
  for (std::size_t i = 0; i < kStageNames.size(); ++i)
    g.row({side + ("_" + key_of(kStageNames[i])) + "_s", kStageNames[i], "\u00b5s", 1e6},
          at([i](const SideData& d) { return time_figures(d.stages[i]); }));
  g.row({std::string(side) + "_busy_s", "busy in all", "\u00b5s", 1e6},
        at([](const SideData& d) { return time_figures(d.busy); }));
}

template <typename At>
void overrun_rows(GroupBuilder& g, const std::string& side, const At& at) {
  const auto timed = [](const SideData& d) {
    return std::any_of(d.busy.begin(), d.busy.end(), [](float x) { return std::isfinite(x); });
  };
  const auto row = [&](const char* key, const char* label, const char* unit, double scale,
                       std::function<double(const SideData&)> f) {
    g.row({side + "_" + key, std::string(label) + ", " + side, unit, scale, unit[0] == '\0'},
          at([=](const SideData& d) { return timed(d) ? Values{f(d)} : Values{}; }));
  };
  row("overruns", "overruns", "", 1,
      [](const SideData& d) { return static_cast<double>(d.overruns); });
  row("overrun_own_s", "late by itself", "ms", 1e3,
      [](const SideData& d) { return d.overrun_own_us * 1e-6; });
  row("overrun_machine_s", "late by the machine", "ms", 1e3,
      [](const SideData& d) { return d.overrun_machine_us * 1e-6; });
}

template <typename At>
void mode_rows(GroupBuilder& g, const std::string& side, const At& at) {
  for (std::uint8_t mode = 0; mode < 4; ++mode) {
    const std::string name = to_string(static_cast<Mode>(mode));
    g.row(
        {side + "_" + name + "_ratio", name + ", " + side, "%", 100}, at([mode](const SideData& d) {
          const auto n = std::count(d.mode.begin(), d.mode.end(), mode);
          return n == 0 ? Values{} : Values{static_cast<double>(n) / static_cast<double>(d.size())};
        }));
  }
}

template <typename At>
void limit_rows(GroupBuilder& g, const std::string& side, const At& at) {
  for (int bit = 0; bit < kLimitCount; ++bit)
    g.row({side + "_limit_" + limit_name(bit) + "_ticks", key_of(limit_name(bit)) + ", " + side, "",
           1, true},
          at([bit](const SideData& d) {
            const auto n = std::count_if(d.limits.begin(), d.limits.end(),
                                         [bit](LimitSet s) { return (s >> bit) & 1u; });
            return n == 0 ? Values{} : Values{static_cast<double>(n)};
          }));
}

SummaryGroup both_sides(GroupBuilder g, const auto& rows) {
  rows(g, "master", [](OfSide f) { return at_master(f); });
  rows(g, "slave", [](OfSide f) { return at_slave(f); });
  return g.group;
}

}  // namespace

std::vector<SummaryGroup> summarize(const std::vector<RunData>& runs) {
  GroupBuilder master = times(runs, "Tick time, master"), slave = times(runs, "Tick time, slave");
  stage_rows(master, "master", [](OfSide f) { return at_master(f); });
  stage_rows(slave, "slave", [](OfSide f) { return at_slave(f); });
  std::vector<SummaryGroup> groups{
      run_group(runs),
      tracking_group(runs),
      force_group(runs),
      energy_group(runs),
      link_group(runs),
      losses_group(runs),
      master.group,
      slave.group,
      both_sides(singles(runs, "Overruns"), [](auto&&... a) { overrun_rows(a...); }),
      both_sides(singles(runs, "Time in each state"), [](auto&&... a) { mode_rows(a...); }),
      both_sides(singles(runs, "Ticks in which a limit acted"),
                 [](auto&&... a) { limit_rows(a...); })};
  std::erase_if(groups, [](const SummaryGroup& g) { return g.rows.empty(); });
  return groups;
}

}  // namespace farhand
