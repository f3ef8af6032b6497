#include "tests/loop/loopback.hpp"

#include <algorithm>

#include "common/scene_network.hpp"

namespace farhand {
namespace {

// One scene seed feeds several generators; each gets a number of its own.
enum Stream : std::uint64_t { kHandStream = 1, kRobotStream, kToSlaveStream, kToMasterStream };
constexpr std::uint64_t stream(std::uint64_t seed, Stream which) {
  return seed * 8 + which;
}

AnyDevice device_of(const Scene& scene, const LoopbackOptions& options) {
  if (options.device) return *options.device;
  return make_device(scene, options.trace,
                     stream(options.seed.value_or(scene.proto.seed()), kHandStream));
}

}  // namespace

Loopback::Loopback(const Scene& scene, const LoopbackOptions& options)
    : loop_(master_loop_config(scene.proto)),
      master_(master_config(scene.proto)),
      device_(device_of(scene, options)),
      link_(link_config(scene, 1)),
      end_(kStart + from_seconds(options.duration_s.value_or(scene.proto.duration_s()))) {
  if (scene.proto.has_slave()) slave_.emplace(scene, options.seed.value_or(scene.proto.seed()));
}

Loopback::SlaveSide::SlaveSide(const Scene& scene, std::uint64_t seed)
    : loop(slave_loop_config(scene.proto)),
      slave(slave_config(scene.proto)),
      robot(make_robot(scene.proto, stream(seed, kRobotStream))),
      link(link_config(scene, 2)),
      to_slave(to_slave_config(scene.proto.link()), stream(seed, kToSlaveStream)),
      to_master(to_master_config(scene.proto.link()), stream(seed, kToMasterStream)),
      phase(loop.period, kStart + loop.period / 2) {}

void Loopback::push(Impairment& network, std::span<const std::byte> datagram) noexcept {
  if (!cut_ && !datagram.empty()) network.push(datagram, now_);
}

void Loopback::run() {
  run_until(end_);
}

void Loopback::run_until(TimePoint until) {
  for (;;) {
    const TimePoint at = next_event();
    if (at >= until) return;
    now_ = at;
    if (slave_) {
      deliver();
      if (slave_due() <= now_) slave_tick();
    }
    if (cut_off_ && (answered() || *cut_off_ <= now_)) actuate();
    if (next_sample_ <= now_ && !cut_off_) sample();
  }
}

TimePoint Loopback::next_event() const noexcept {
  TimePoint at = cut_off_ ? *cut_off_ : next_sample_;
  if (!slave_) return at;
  at = std::min(at, slave_due());
  if (const auto due = slave_->to_slave.next_due(); due && slave_->takes())
    at = std::min(at, std::max(*due, slave_->stalled_until));
  if (const auto due = slave_->to_master.next_due()) at = std::min(at, *due);
  return std::max(at, now_);
}

TimePoint Loopback::slave_due() const noexcept {
  return std::max(slave_->phase.due(slave_->arrival), slave_->stalled_until);
}

void Loopback::deliver() noexcept {
  while (now_ >= slave_->stalled_until && slave_->takes()) {
    const auto datagram = slave_->to_slave.pop(now_, buffer_);
    if (datagram.empty()) break;
    ++slave_->taken;
    slave_->link.receive(datagram, now_);
  }
  for (auto d = slave_->to_master.pop(now_, buffer_); !d.empty();
       d = slave_->to_master.pop(now_, buffer_))
    link_.receive(d, now_);
  const auto* newest = slave_->link.newest();
  if (newest != nullptr && newest->sequence != slave_->ticked_sequence)
    slave_->arrival = newest->received;
}

void Loopback::slave_tick() {
  SlaveSide& s = *slave_;
  const RobotReading reading = read(s.robot, now_);
  const SlaveTick& tick =
      s.slave.tick(now_, peer<MasterToSlave>(s.link, now_, s.loop.lost), reading);
  write(s.robot, now_, tick.tau);
  push(s.to_master, s.link.hello_due(now_));
  push(s.to_master, s.link.encode(tick.out, now_));
  s.phase.ticked(now_, s.arrival);
  s.arrival.reset();
  s.taken = 0;
  if (s.link.newest() != nullptr) s.ticked_sequence = s.link.newest()->sequence;
  on_slave(tick);
}

void Loopback::sample() {
  HandleReading reading = read(device_, now_);
  on_reading(reading);
  const MasterToSlave& message =
      master_.sample(now_, reading, peer<SlaveToMaster>(link_, now_, loop_.lost));
  next_sample_ += loop_.period;
  cut_off_ = now_;
  if (!slave_) return;
  push(slave_->to_slave, link_.hello_due(now_));
  push(slave_->to_slave, link_.encode(message, now_));
  sent_sequence_ = link_.sequence();
  cut_off_ = now_ + loop_.cut_off;
}

void Loopback::actuate() {
  cut_off_.reset();
  const MasterTick& tick = master_.actuate(now_, peer<SlaveToMaster>(link_, now_, loop_.lost));
  write(device_, now_, tick.tau);
  on_master(tick);
}

bool Loopback::answered() const noexcept {
  return slave_ && link_.newest() != nullptr && link_.newest()->echo_sequence >= sent_sequence_ &&
         sent_sequence_ > 0;
}

}  // namespace farhand
