#include "common/report/merge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace farhand {
namespace {

std::int64_t median(std::vector<std::int64_t> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

std::int64_t end_ns(const RunData& run) {
  return run.start_ns() + std::llround(run.duration() * 1e9);
}

bool is_one_run(const RunData& master, const RunData& slave) {
  if (master.role != "master" || slave.role != "slave" || !master.master || !slave.slave)
    return false;
  if (master.scene_hash != slave.scene_hash || master.slave) return false;
  const std::int64_t shift = shift_to_master(master, slave);
  return slave.start_ns() + shift <= end_ns(master) && master.start_ns() <= end_ns(slave) + shift;
}

void move_start(SideData& side, std::int64_t run_start_ns) {
  const double later = static_cast<double>(side.start_ns - run_start_ns) * 1e-9;
  for (double& t : side.t) t += later;
}

void join(RunData& master, RunData slave) {
  slave.slave->start_ns += shift_to_master(master, slave);
  master.slave = std::move(slave.slave);
  const std::int64_t start = master.start_ns();
  move_start(*master.master, start);
  move_start(*master.slave, start);
  master.files.insert(master.files.end(), slave.files.begin(), slave.files.end());
  master.notes.insert(master.notes.end(), slave.notes.begin(), slave.notes.end());
}

}  // namespace

std::int64_t shift_to_master(const RunData& master, const RunData& slave) {
  std::int64_t slave_minus_master = 0;
  if (master.master && !master.master->clock_offset_ns.empty())
    slave_minus_master = median(master.master->clock_offset_ns);
  else if (slave.slave && !slave.slave->clock_offset_ns.empty())
    slave_minus_master = -median(slave.slave->clock_offset_ns);
  else
    return 0;
  return master.epoch_minus_monotonic_ns - slave.epoch_minus_monotonic_ns - slave_minus_master;
}

std::vector<RunData> merge_runs(std::vector<RunData> runs) {
  std::vector<RunData> out;
  std::vector<bool> taken(runs.size(), false);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (taken[i]) continue;
    for (std::size_t j = i + 1; j < runs.size(); ++j) {
      if (taken[j]) continue;
      if (is_one_run(runs[j], runs[i])) std::swap(runs[i], runs[j]);
      if (!is_one_run(runs[i], runs[j])) continue;
      join(runs[i], std::move(runs[j]));
      taken[j] = true;
      break;
    }
    out.push_back(std::move(runs[i]));
  }
  return out;
}

}  // namespace farhand
