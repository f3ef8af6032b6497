#include "common/report/run_file.hpp"

#include <spdlog/fmt/fmt.h>

#include <cstdlib>
#include <stdexcept>

#include "common/mcap_reader.hpp"

namespace farhand {
namespace {

template <typename Record>
bool parse(Record& record, std::span<const std::byte> data) {
  return record.ParseFromArray(data.data(), static_cast<int>(data.size()));
}

std::string find(const mcap::TextMap& map, const std::string& key) {
  const auto it = map.find(key);
  return it == map.end() ? std::string() : it->second;
}

void describe(RunData& run, const McapReader& reader) {
  for (const auto& [name, map] : reader.metadata())
    run.metadata[name].insert(map.begin(), map.end());
  const auto own = reader.metadata().find("farhand");
  if (own != reader.metadata().end()) {
    run.role = find(own->second, "role");
    run.scene_hash = find(own->second, "scene_hash");
    run.scene_path = find(own->second, "scene_path");
    run.epoch_minus_monotonic_ns =
        std::strtoll(find(own->second, "epoch_minus_monotonic_ns").c_str(), nullptr, 10);
  }
  const auto scene = reader.attachments().find("scene.textproto");
  if (scene != reader.attachments().end()) run.scene_text = scene->second;
}

// Its ticks, side by side as they come.
struct Sides {
  MasterColumns master;
  SlaveColumns slave;
  record::MasterRecord master_record;
  record::SlaveRecord slave_record;
  std::uint64_t unreadable = 0;

  void add(const McapReader::Message& m) {
    const auto at = static_cast<std::int64_t>(m.log_time_ns);
    if (m.topic == "/master") {
      if (parse(master_record, m.data))
        master.add(at, master_record);
      else
        ++unreadable;
    } else if (m.topic == "/slave") {
      if (parse(slave_record, m.data))
        slave.add(at, slave_record);
      else
        ++unreadable;
    }
  }
};

void move_start(SideData& side, std::int64_t run_start_ns) {
  const double later = static_cast<double>(side.start_ns - run_start_ns) * 1e-9;
  for (double& t : side.t) t += later;
}

void take_sides(RunData& run, Sides& sides) {
  MasterData master = sides.master.take();
  SlaveData slave = sides.slave.take();
  if (master.size() > 0) run.master = std::move(master);
  if (slave.size() > 0) run.slave = std::move(slave);
  const std::int64_t start = run.start_ns();
  if (run.master) move_start(*run.master, start);
  if (run.slave) move_start(*run.slave, start);
}

void note_damage(RunData& run, const McapReader& reader, const std::string& path,
                 std::uint64_t unreadable) {
  if (!reader.complete())
    run.notes.push_back(path + " is cut off: what is here ends at its last whole chunk.");
  for (const std::string& sentence : reader.damage()) run.notes.push_back(path + ": " + sentence);
  if (unreadable > 0)
    run.notes.push_back(
        fmt::format("{}: {} records could not be read and are left out.", path, unreadable));
}

}  // namespace

RunData read_run(const std::string& path, const Progress& progress) {
  McapReader reader(path);
  Sides sides;
  McapReader::Message message;
  constexpr std::uint64_t kTellEach = 20000;
  const auto total = static_cast<double>(std::max<std::uint64_t>(reader.file_bytes(), 1));
  for (std::uint64_t i = 0; reader.next(message); ++i) {
    sides.add(message);
    if (i % kTellEach == 0) progress(static_cast<double>(reader.bytes_read()) / total);
  }
  progress(1);
  RunData run;
  run.files = {path};
  describe(run, reader);
  take_sides(run, sides);
  if (!run.master && !run.slave)
    throw std::runtime_error(path +
                             " has no tick on /master or /slave: record one with "
                             "farhand-master, farhand-slave or farhand-loopback --record");
  note_damage(run, reader, path, sides.unreadable);
  return run;
}

}  // namespace farhand
