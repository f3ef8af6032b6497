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

using OfRun = std::function<Figures(const RunData&)>;
using OfMaster = std::function<Figures(const MasterData&)>;
using OfSlave = std::function<Figures(const SlaveData&)>;
using OfSide = std::function<double(const SideData&)>;

OfRun at_master(OfMaster f) {
  return [f = std::move(f)](const RunData& r) { return r.master ? f(*r.master) : Figures{}; };
}
OfRun at_slave(OfSlave f) {
  return [f = std::move(f)](const RunData& r) { return r.slave ? f(*r.slave) : Figures{}; };
}

constexpr auto kEngaged = static_cast<std::uint8_t>(Mode::engaged);

enum class Touch { free, contact };

// How the user's force is known. Rows of either kind, so that an estimate never passes for a
// measurement.
struct Source {
  bool estimated;
  const char* key;
  const char* label;
};
constexpr Source kSources[] = {{false, "", ""}, {true, "estimated_", ", F_u estimated"}};

// Size of a - b on the hand's side while engaged, as the programs' own tables have it.
OfRun hand_error(const Columns<3> MasterData::*a, const Columns<3> MasterData::*b, Touch touch,
                 bool estimated) {
  return at_master([=](const MasterData& m) {
    if (m.user_estimated != estimated) return Figures{};
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
      shape.runs.push_back(f(run));
      any = any || !shape.runs.back().empty();
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

GroupBuilder sides(const std::vector<RunData>& runs, std::string name) {
  return {runs, {std::move(name), {"master", "slave"}, {"master", "slave"}, {}}};
}

SummaryGroup run_group(const std::vector<RunData>& runs) {
  GroupBuilder g = singles(runs, "Run");
  g.row({"duration_s", "duration", "s", 1, 2},
        [](const RunData& r) { return Figures{r.duration()}; });
  g.row({"coupled_ratio", "coupled", "%", 100, 1}, at_slave([](const SlaveData& s) {
          const auto n = std::count(s.coupled.begin(), s.coupled.end(), 1);
          return Figures{static_cast<double>(n) / static_cast<double>(s.size())};
        }));
  g.row({"contact_ratio", "in contact (over 0.5 N)", "%", 100, 1}, at_slave([](const SlaveData& s) {
          const Column f = length(s.contact_force);
          const auto n =
              std::count_if(f.begin(), f.end(), [](float x) { return x > kContactForce; });
          return Figures{static_cast<double>(n) / static_cast<double>(s.size())};
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
    for (const Source& s : kSources)
      g.row({std::string(s.key) + key, std::string(label) + s.label, torque ? "mN m" : "N",
             torque ? 1e3 : 1},
            torque ? hand_error(&MasterData::user_torque, &MasterData::environment_torque, touch,
                                s.estimated)
                   : hand_error(&MasterData::user_force, &MasterData::environment_force, touch,
                                s.estimated));
  };
  row("force_error_free_n", "F_u \u2212 F_e, free", false, Touch::free);
  row("force_error_contact_n", "F_u \u2212 F_e, in contact", false, Touch::contact);
  row("torque_error_free_nm", "torque, free", true, Touch::free);
  row("torque_error_contact_nm", "torque, in contact", true, Touch::contact);
  const auto size = [&](const char* key, const char* label, auto at, auto force) {
    g.row({key, label, "N"}, at([force](const auto& side) {
            return error_figures(select(length(side.*force),
                                        [&](std::size_t i) { return side.mode[i] == kEngaged; }));
          }));
  };
  size(
      "coupling_force_n", "of the coupling to the robot", [](auto f) { return at_master(f); },
      &MasterData::coupling_force);
  size(
      "boundary_force_n", "of the boundary, at the tool", [](auto f) { return at_slave(f); },
      &SlaveData::boundary_force);
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
    return d.work.empty() ? Figures{} : Figures{d.work.back()};
  };
  g.row({"work_on_hand_j", "given to the hand", "mJ", 1e3}, at_master(last));
  g.row({"work_on_environment_j", "given to the environment", "mJ", 1e3}, at_slave(last));
  g.row({"generated_peak_j", "generated between, peak", "mJ", 1e3}, [](const RunData& r) {
    if (!r.master || !r.slave) return Figures{};
    const Column e = generated_energy(*r.master, *r.slave);
    return e.empty() ? Figures{} : Figures{*std::max_element(e.begin(), e.end())};
  });
  return g.group;
}

// While engaged: before and after it, ages only tell how long ago the partner came or went.
Figures age_figures(const SideData& d) {
  Column us = select(d.age, [&](std::size_t i) { return d.mode[i] == kEngaged; });
  for (float& age : us) age *= 1e6f;
  return time_figures(us);
}

SummaryGroup link_group(const std::vector<RunData>& runs) {
  GroupBuilder g = times(runs, "Link, ages while engaged");
  g.row({"round_trip_s", "round trip", "\u00b5s", 1e6},
        at_master([](const MasterData& m) { return time_figures(m.round_trip); }));
  g.row({"master_age_s", "age at the master", "\u00b5s", 1e6}, at_master(age_figures));
  g.row({"slave_age_s", "age at the slave", "\u00b5s", 1e6}, at_slave(age_figures));
  return g.group;
}

std::string key_of(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

template <typename At>
SummaryGroup stage_group(const std::vector<RunData>& runs, const std::string& side, const At& at) {
  GroupBuilder g = times(runs, "Tick time, " + side);
  for (std::size_t i = 0; i < kStageNames.size(); ++i)
    g.row({side + "_" + key_of(kStageNames[i]) + "_s", kStageNames[i], "\u00b5s", 1e6},
          at([i](const SideData& d) { return time_figures(d.stages[i]); }));
  g.row({side + "_busy_s", "busy in all", "\u00b5s", 1e6},
        at([](const SideData& d) { return time_figures(d.busy); }));
  return g.group;
}

// A value of each side; NaN: none.
OfRun of_sides(OfSide f) {
  return [f = std::move(f)](const RunData& r) {
    const Figures both{r.master ? f(*r.master) : NAN, r.slave ? f(*r.slave) : NAN};
    return std::isnan(both[0]) && std::isnan(both[1]) ? Figures{} : both;
  };
}

SummaryGroup losses_group(const std::vector<RunData>& runs) {
  GroupBuilder g = sides(runs, "Datagrams and jitter");
  struct Counter {
    const char *key, *label;
    std::uint64_t LinkTotals::*count;
  };
  static constexpr Counter kCounters[] = {{"received", "received", &LinkTotals::received},
                                          {"lost", "lost", &LinkTotals::lost},
                                          {"dropped", "dropped", &LinkTotals::dropped},
                                          {"reordered", "reordered", &LinkTotals::reordered},
                                          {"not_sent", "not sent", &LinkTotals::not_sent}};
  for (const Counter& c : kCounters)
    g.row({c.key, c.label, "", 1, 0},
          of_sides([&](const SideData& d) { return static_cast<double>(d.link.*c.count); }));
  g.row({"jitter_s", "jitter of the round trip", "\u00b5s", 1e6},
        of_sides([](const SideData& d) { return jitter(d.round_trip); }));
  return g.group;
}

// Only of programs in real time, which time their stages.
OfRun if_timed(double (*f)(const SideData&)) {
  return of_sides([f](const SideData& d) {
    const auto is_known = [](float x) { return std::isfinite(x); };
    return std::any_of(d.busy.begin(), d.busy.end(), is_known) ? f(d) : NAN;
  });
}

SummaryGroup overrun_group(const std::vector<RunData>& runs) {
  GroupBuilder g = sides(runs, "Overruns");
  g.row({"overruns", "overruns", "", 1, 0},
        if_timed([](const SideData& d) { return static_cast<double>(d.overruns); }));
  g.row({"overrun_own_s", "late by our own CPU time", "ms", 1e3},
        if_timed([](const SideData& d) { return d.overrun_own_us * 1e-6; }));
  g.row({"overrun_machine_s", "late by the machine", "ms", 1e3},
        if_timed([](const SideData& d) { return d.overrun_machine_us * 1e-6; }));
  return g.group;
}

SummaryGroup mode_group(const std::vector<RunData>& runs) {
  GroupBuilder g = sides(runs, "Ticks, and share in each state");
  g.row({"ticks", "ticks", "", 1, 0},
        of_sides([](const SideData& d) { return static_cast<double>(d.size()); }));
  for (std::uint8_t mode = 0; mode < kModes; ++mode) {
    const std::string name = to_string(static_cast<Mode>(mode));
    g.row({name + "_ratio", name, "%", 100, 2}, of_sides([mode](const SideData& d) {
            const auto n = std::count(d.mode.begin(), d.mode.end(), mode);
            return static_cast<double>(n) / static_cast<double>(d.size());
          }));
  }
  return g.group;
}

// As the recordings name them, so that a file of another version keeps its meaning.
std::map<int, std::string> limit_names(const std::vector<RunData>& runs) {
  std::map<int, std::string> names;
  for (const RunData& run : runs) {
    const auto own = run.metadata.find("limits");
    if (own == run.metadata.end()) continue;
    for (const auto& [bit, name] : own->second) names.emplace(std::atoi(bit.c_str()), name);
  }
  std::erase_if(names, [](const auto& item) { return item.first < 0 || item.first > 31; });
  return names;
}

SummaryGroup limit_group(const std::vector<RunData>& runs) {
  GroupBuilder g = sides(runs, "Ticks in which a limit acted");
  for (const auto& [bit, name] : limit_names(runs))
    g.row({"limited_" + name + "_ticks", name, "", 1, 0}, of_sides([bit = bit](const SideData& d) {
            return static_cast<double>(
                std::count_if(d.limits.begin(), d.limits.end(),
                              [bit](LimitSet s) { return ((s >> bit) & 1u) != 0; }));
          }));
  std::erase_if(g.group.rows, [](const SummaryRow& row) {
    return std::all_of(row.runs.begin(), row.runs.end(), [](const Figures& f) {
      return std::none_of(f.begin(), f.end(), [](double n) { return n > 0; });
    });
  });
  return g.group;
}

}  // namespace

std::vector<SummaryGroup> summarize(const std::vector<RunData>& runs) {
  std::vector<SummaryGroup> groups{
      run_group(runs),
      tracking_group(runs),
      force_group(runs),
      energy_group(runs),
      link_group(runs),
      losses_group(runs),
      stage_group(runs, "master", [](const auto& f) { return at_master(f); }),
      stage_group(runs, "slave", [](const auto& f) { return at_slave(f); }),
      overrun_group(runs),
      mode_group(runs),
      limit_group(runs)};
  std::erase_if(groups, [](const SummaryGroup& g) { return g.rows.empty(); });
  return groups;
}

}  // namespace farhand
