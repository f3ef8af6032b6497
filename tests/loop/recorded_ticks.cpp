#include "tests/loop/recorded_ticks.hpp"

#include "tests/loop/loopback.hpp"

namespace farhand {

RecordedTicks record_ticks(const Scene& scene, std::size_t ticks) {
  RecordedTicks out;
  MasterToSlave sent;
  Loopback loop(scene, {});
  loop.on_master = [&](const MasterTick& t) {
    sent = t.out;
    if (t.age < Duration::max()) out.master.push_back({t.now, t.reading, *loop.heard()});
  };
  loop.on_slave = [&](const SlaveTick& t) { out.slave.push_back({t.now, sent, t.robot}); };
  while (out.master.size() < ticks && loop.now() < loop.end())
    loop.run_until(loop.now() + std::chrono::milliseconds(100));
  return out;
}

}  // namespace farhand
