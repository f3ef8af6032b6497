// The master's real-time shell: clock, socket and device around the two halves of the tick.
#pragma once

#include <atomic>
#include <cstdint>

#include "common/link.hpp"
#include "common/loop_report.hpp"
#include "common/realtime.hpp"
#include "common/recorder.hpp"
#include "common/udp.hpp"
#include "master/ahrs/ahrs_line.hpp"
#include "master/devices.hpp"
#include "master/master.hpp"

namespace farhand {

// One tick as it is recorded: what was decided, what it cost, and the link at that moment.
struct MasterRecord {
  MasterTick tick;
  LoopTiming timing;
  LinkStatus link;
};

struct MasterLoopConfig {
  Duration period{std::chrono::milliseconds(1)};
  Duration cut_off{std::chrono::microseconds(400)};  // how long to wait for the answer
  Duration lost{std::chrono::milliseconds(500)};     // silence after which the slave is gone
  Duration spin{};  // before the tick, and once the question is out: watched, not slept through
  Duration park{};  // at the end, how long position control may take to park the grip
};

class MasterLoop {
 public:
  // To be made on the thread that turns it. Everything is borrowed and must outlive the loop;
  // socket and link are nullptr for a scene without a slave, ahrs for one without a serial AHRS.
  MasterLoop(const MasterLoopConfig& config, Master& master, AnyDevice& device, MasterLink* link,
             UdpSocket* socket, AhrsLine* ahrs, Recorder<MasterRecord>& recorder) noexcept;

  // Turns until a stop is requested, `limit` has passed or another master took over; then parks the
  // grip if asked to, lets the force fade, tells the slave, and leaves the motors at zero torque.
  void run(Duration limit) noexcept;

  // One period: wait for its begin, sample, send, wait for the answer, actuate, write.
  void turn() noexcept;

 private:
  Peer<SlaveToMaster> slave(TimePoint now) const noexcept;
  TimePoint wake() noexcept;
  void send(const MasterToSlave& message) noexcept;
  void await_answer() noexcept;
  bool wait_readable(TimePoint spun) noexcept;
  void receive() noexcept;
  bool answered() const noexcept;
  bool taken_over() const noexcept;
  void park() noexcept;
  void finish(TimePoint end, Duration busy) noexcept;

  MasterLoopConfig config_;
  Master& master_;
  AnyDevice& device_;
  MasterLink* link_;
  UdpSocket* socket_;
  AhrsLine* ahrs_;
  Recorder<MasterRecord>& recorder_;
  OverrunSplit split_;
  TimePoint next_{};
  TimePoint cut_off_{};  // of this turn's wait for the answer
  std::uint64_t sent_sequence_ = 0;
  MasterRecord* record_ = nullptr;  // this turn's, in the recorder's queue
};

}  // namespace farhand
