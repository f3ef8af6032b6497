// Both sides in one process under virtual time: the same ticks, links and simulated hardware as the
// two programs, with a seeded network between them. The same scene, seed and build give the same
// bits. What goes wrong may be told it while it runs: stalls, restarts, clocks that step, another
// network, datagrams from nowhere.
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
#include "tests/loop/network_way.hpp"
#include "tests/loop/side_clock.hpp"

namespace farhand {

enum class Side : std::uint8_t { master, slave };

struct LoopbackOptions {
  std::optional<std::uint64_t> seed;  // instead of the scene's
  std::optional<double> duration_s;   // instead of the scene's
  std::optional<std::string> trace;   // motion of the simulated hand
  std::optional<AnyDevice> device;    // instead of the simulated hand
  ClockError master_clock{}, slave_clock{};
};

class Loopback {
 public:
  Loopback(const Scene& scene, const LoopbackOptions& options);

  // What device and robot say may be changed before their side hears it.
  std::function<void(HandleReading&)> on_reading = [](HandleReading&) {};
  std::function<void(RobotReading&)> on_robot = [](RobotReading&) {};
  // Called once per tick, after its command was written.
  std::function<void(const MasterTick&)> on_master = [](const MasterTick&) {};
  std::function<void(const SlaveTick&)> on_slave = [](const SlaveTick&) {};
  // A channel around the links' datagrams, if there is one: what is given to the network in place
  // of a datagram, and what the link is given in place of one that arrived; empty: nothing.
  using Channel = std::function<std::span<const std::byte>(Side, std::span<const std::byte>)>;
  Channel on_send, on_arrival;
  // Every datagram that enters the network, on its way to a side.
  std::function<void(Side to, std::span<const std::byte>)> on_sent = [](Side, auto) {};
  // Every datagram a side has read, as it arrived, and whether its link took it.
  std::function<void(Side to, std::span<const std::byte>, bool accepted)> on_received =
      [](Side, auto, bool) {};

  // From here on, now() is the present.
  //
  // The side does not turn for so long; what arrives waits in its socket. A device lets go of its
  // motors when nobody has written for kWatchdog; the simulated robot rests then.
  void stall(Side side, Duration length);
  // The side's process ends, and another one with this session starts after `length`. Device and
  // robot stay where they are.
  void restart(Side side, Duration length, std::uint64_t session);
  void step_clock(Side side, Duration forward) noexcept;
  // The side's device or robot: neither readings nor torques pass.
  void unplug(Side side, bool on) noexcept;
  // The simulated hand turns at this rate besides its motion (master/sim_hand.hpp).
  void turn_hand(const Vec3& rate) noexcept;
  void change_network(const std::optional<ImpairmentConfig>& to_slave,
                      const std::optional<ImpairmentConfig>& to_master);
  // Enters the network on its way to a side, or reaches that side at once.
  void send(Side to, std::span<const std::byte> datagram) noexcept;
  void inject(Side to, std::span<const std::byte> datagram);

  // While a way is cut, nothing more enters it; what is under way arrives.
  void cut(bool to_slave, bool to_master) noexcept { cut_ = {to_master, to_slave}; }

  // Runs to the end of the scene's duration.
  void run();
  // Runs up to `until`, exclusive.
  void run_until(TimePoint until);

  TimePoint start() const noexcept { return kStart; }
  TimePoint end() const noexcept { return end_; }
  TimePoint now() const noexcept { return now_; }
  // Turning: neither stalled nor away.
  bool up(Side side) const noexcept { return now_ >= outage(side).until; }

  const SideClock& clock(Side side) const noexcept {
    return side == Side::master ? clock_ : slave_->clock;
  }

  // What a checker may look at.
  const AnyDevice& device() const noexcept { return device_; }
  const AnyRobot* robot() const noexcept { return slave_ ? &slave_->robot : nullptr; }
  const Master& master() const noexcept { return *master_; }
  const Slave* slave() const noexcept { return slave_ ? &*slave_->slave : nullptr; }
  // The newest message the master has; nullptr before the first.
  const SlaveToMaster* heard() const noexcept {
    return link_->newest() != nullptr ? &link_->newest()->message : nullptr;
  }
  const MasterLink& master_end() const noexcept { return *link_; }
  const SlaveLink* slave_end() const noexcept { return slave_ ? &*slave_->link : nullptr; }
  const LinkCounters& master_link() const noexcept { return link_->counters(); }
  const LinkCounters* slave_link() const noexcept {
    return slave_ ? &slave_->link->counters() : nullptr;
  }
  const LinkQuality& quality() const noexcept { return link_->quality(); }
  LinkStatus master_status() const noexcept { return link_status(*link_, 0); }
  LinkStatus slave_status() const noexcept {
    return slave_ ? link_status(*slave_->link, 0) : LinkStatus{};
  }

 private:
  static constexpr TimePoint kStart{std::chrono::seconds(1)};
  static constexpr Duration kWatchdog = std::chrono::milliseconds(50);

  // A side that does not turn, and the session it starts with if it is a new process then.
  struct Outage {
    TimePoint since{}, until{};
    std::optional<std::uint64_t> session;
  };
  struct SlaveSide {
    SlaveSide(const Loopback& loop, std::uint64_t seed);

    SlaveLoopConfig loop;
    std::optional<Slave> slave;
    AnyRobot robot;
    std::optional<SlaveLink> link;
    NetworkWay to_slave, to_master;
    std::optional<PhaseLock> phase;
    SideClock clock;
    Outage outage;
    SocketQueue socket;
    bool unplugged = false;
    std::uint64_t ticked_sequence = 0;
    std::optional<TimePoint> arrival;  // of the newest message no tick has used
  };

  void push(Side to, std::span<const std::byte> datagram) noexcept;
  const Outage& outage(Side side) const noexcept;
  void interrupt(Side side, const Outage& outage);
  TimePoint next_event() const noexcept;
  TimePoint master_due() const noexcept;
  TimePoint slave_due() const noexcept;
  void deliver();
  void arrive(Side to, std::span<const std::byte> datagram);
  void receive(Side to, std::span<const std::byte> datagram) noexcept;
  void note_arrival() noexcept;
  void turn_master();
  void turn_slave();
  void start_master(std::uint64_t session);
  void start_slave(std::uint64_t session);
  void idle_device() noexcept;
  void let_go() noexcept;
  void slave_tick();
  void sample();
  void actuate();
  bool answered() const noexcept;

  Scene scene_;
  MasterLoopConfig loop_;
  std::optional<Master> master_;
  AnyDevice device_;
  std::optional<MasterLink> link_;
  SideClock clock_;
  Outage outage_;
  TimePoint next_idle_{};
  std::optional<TimePoint> unplugged_;  // the device, since
  SocketQueue socket_;
  std::optional<SlaveSide> slave_;

  TimePoint now_ = kStart;
  TimePoint end_;
  TimePoint next_sample_;             // as cut_off_ on the master's clock
  std::array<bool, 2> cut_{};         // the way to master, to slave
  std::optional<TimePoint> cut_off_;  // while an answer is awaited
  std::uint64_t sent_sequence_ = 0;
  std::array<std::byte, kMaxDatagramBytes> buffer_{};
};

}  // namespace farhand
