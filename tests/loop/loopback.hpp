// Both sides in one process under virtual time: the same ticks, links and simulated hardware as the
// two programs, with a seeded network between them. The same scene, seed and build give the same
// bits.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "common/impairment.hpp"
#include "common/link.hpp"
#include "common/phase_lock.hpp"
#include "common/scene.hpp"
#include "master/build.hpp"
#include "master/devices.hpp"
#include "master/master.hpp"
#include "slave/build.hpp"
#include "slave/robots.hpp"
#include "slave/slave.hpp"

namespace farhand {

struct LoopbackOptions {
  std::optional<std::uint64_t> seed;  // instead of the scene's
  std::optional<double> duration_s;   // instead of the scene's
  std::optional<std::string> trace;   // motion of the simulated hand
  std::optional<AnyDevice> device;    // instead of the simulated hand
};

class Loopback {
 public:
  Loopback(const Scene& scene, const LoopbackOptions& options);

  // What the device says may be changed before the master hears it.
  std::function<void(HandleReading&)> on_reading = [](HandleReading&) {};
  // Called once per tick, after its command was written.
  std::function<void(const MasterTick&)> on_master = [](const MasterTick&) {};
  std::function<void(const SlaveTick&)> on_slave = [](const SlaveTick&) {};

  // While cut, nothing more enters the network; what is under way arrives.
  void cut(bool on) noexcept { cut_ = on; }

  // For so long the slave neither ticks nor receives; then it takes what waits, a burst a tick.
  void stall_slave(Duration length) noexcept { slave_->stalled_until = now_ + length; }

  // Runs to the end of the scene's duration.
  void run();
  // Runs up to `until`, exclusive.
  void run_until(TimePoint until);

  TimePoint start() const noexcept { return kStart; }
  TimePoint end() const noexcept { return end_; }
  TimePoint now() const noexcept { return now_; }

  // What a checker may look at.
  const AnyDevice& device() const noexcept { return device_; }
  const AnyRobot* robot() const noexcept { return slave_ ? &slave_->robot : nullptr; }
  const Master& master() const noexcept { return master_; }
  const Slave* slave() const noexcept { return slave_ ? &slave_->slave : nullptr; }
  // The newest message the master has; nullptr before the first.
  const SlaveToMaster* heard() const noexcept {
    return link_.newest() != nullptr ? &link_.newest()->message : nullptr;
  }
  const LinkCounters& master_link() const noexcept { return link_.counters(); }
  const LinkCounters* slave_link() const noexcept {
    return slave_ ? &slave_->link.counters() : nullptr;
  }
  const LinkQuality& quality() const noexcept { return link_.quality(); }
  LinkStatus master_status() const noexcept { return link_status(link_, 0); }
  LinkStatus slave_status() const noexcept {
    return slave_ ? link_status(slave_->link, 0) : LinkStatus{};
  }

 private:
  static constexpr TimePoint kStart{std::chrono::seconds(1)};

  struct SlaveSide {
    SlaveSide(const Scene& scene, std::uint64_t seed);

    SlaveLoopConfig loop;
    Slave slave;
    AnyRobot robot;
    SlaveLink link;
    Impairment to_slave, to_master;
    PhaseLock phase;
    std::uint64_t ticked_sequence = 0;
    std::optional<TimePoint> arrival;  // of the newest message no tick has used
    TimePoint stalled_until{};
    int taken = 0;  // datagrams since the last tick

    bool takes() const noexcept { return taken < SlaveLoop::kBurst; }
  };

  void push(Impairment& network, std::span<const std::byte> datagram) noexcept;
  TimePoint next_event() const noexcept;
  TimePoint slave_due() const noexcept;
  void deliver() noexcept;
  void slave_tick();
  void sample();
  void actuate();
  bool answered() const noexcept;

  MasterLoopConfig loop_;
  Master master_;
  AnyDevice device_;
  MasterLink link_;
  std::optional<SlaveSide> slave_;

  TimePoint now_ = kStart;
  TimePoint end_;
  TimePoint next_sample_ = kStart;
  bool cut_ = false;
  std::optional<TimePoint> cut_off_;  // while an answer is awaited
  std::uint64_t sent_sequence_ = 0;
  std::array<std::byte, kMaxDatagramBytes> buffer_{};
};

}  // namespace farhand
