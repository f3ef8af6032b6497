// The slave's real-time shell: clock, socket and robot around the tick, phase-locked to the
// master's messages.
#pragma once

#include "common/link.hpp"
#include "common/loop_report.hpp"
#include "common/phase_lock.hpp"
#include "common/realtime.hpp"
#include "common/recorder.hpp"
#include "common/udp.hpp"
#include "slave/robots.hpp"
#include "slave/slave.hpp"

namespace farhand {

// One tick as it is recorded: what was decided, what it cost, and the link at that moment.
struct SlaveRecord {
  SlaveTick tick;
  LoopTiming timing;
  LinkStatus link;
};

struct SlaveLoopConfig {
  Duration period{std::chrono::milliseconds(1)};
  Duration lost{std::chrono::milliseconds(500)};  // silence after which the master is gone
  Duration spin{};  // before and after the expected message: watched for, not slept through
};

class SlaveLoop {
 public:
  static constexpr int kBurst = 64;  // datagrams taken at once, at most

  // To be made on the thread that turns it. Everything is borrowed and must outlive the loop.
  SlaveLoop(const SlaveLoopConfig& config, Slave& slave, AnyRobot& robot, SlaveLink& link,
            UdpSocket& socket, Recorder<SlaveRecord>& recorder) noexcept;

  // Turns until a stop is requested or `limit` has passed; then the master counts as gone, the
  // robot comes to rest and is left held, and the master is told.
  void run(Duration limit) noexcept;

  // One period: wait for the master's message or the deadline, read, tick, write, answer if there
  // is something to tell.
  void turn() noexcept;

 private:
  Peer<MasterToSlave> master(TimePoint now) const noexcept;
  // Arrival of the message this tick uses; nothing: the deadline came first.
  std::optional<TimePoint> await_message() noexcept;
  bool wait_readable(TimePoint until) noexcept;
  void receive() noexcept;
  bool newest_for_sure(TimePoint now) const noexcept;
  void send() noexcept;
  void finish(TimePoint planned, TimePoint begin, TimePoint end) noexcept;

  SlaveLoopConfig config_;
  Slave& slave_;
  AnyRobot& robot_;
  SlaveLink& link_;
  UdpSocket& socket_;
  Recorder<SlaveRecord>& recorder_;
  PhaseLock phase_;
  OverrunSplit split_;
  std::uint64_t ticked_sequence_ = 0;
  SlaveRecord* record_ = nullptr;  // this turn's, in the recorder's queue
};

}  // namespace farhand
