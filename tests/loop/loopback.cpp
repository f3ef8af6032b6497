#include "tests/loop/loopback.hpp"

#include <algorithm>
#include <stdexcept>

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
  if (scene.proto.master().has_falcon_usb())
    throw std::runtime_error(
        scene.path +
        ": master.falcon_usb is a real device, which knows no virtual time; run "
        "farhand-master, or put sim_hand {} in its place");
  if (scene.proto.master().ahrs().has_serial())
    throw std::runtime_error(
        scene.path +
        ": master.ahrs.serial is a real line, which knows no virtual time; run farhand-master, or "
        "put simulated {} in its place");
  return make_device(scene, options.trace,
                     stream(options.seed.value_or(scene.proto.seed()), kHandStream));
}

}  // namespace

Loopback::Loopback(const Scene& scene, const LoopbackOptions& options)
    : scene_(scene),
      loop_(master_loop_config(scene.proto)),
      device_(device_of(scene, options)),
      clock_(kStart, options.master_clock),
      end_(kStart + from_seconds(options.duration_s.value_or(scene.proto.duration_s()))) {
  start_master(1);
  if (!scene.proto.has_slave()) return;
  slave_.emplace(*this, options.seed.value_or(scene.proto.seed()));
  slave_->clock = SideClock(kStart, options.slave_clock);
  start_slave(2);
  slave_->phase.emplace(slave_->loop.period, slave_->clock.local(now_) + slave_->loop.period / 2);
}

Loopback::SlaveSide::SlaveSide(const Loopback& of, std::uint64_t seed)
    : loop(slave_loop_config(of.scene_.proto)),
      robot(make_robot(of.scene_.proto, stream(seed, kRobotStream))),
      to_slave(to_slave_config(of.scene_.proto.link()), stream(seed, kToSlaveStream)),
      to_master(to_master_config(of.scene_.proto.link()), stream(seed, kToMasterStream)),
      clock(kStart, {}) {}

void Loopback::start_master(std::uint64_t session) {
  master_.emplace(master_config(scene_.proto));
  link_.emplace(link_config(scene_, session));
  next_sample_ = clock_.local(now_);
  cut_off_.reset();
  sent_sequence_ = 0;
}

void Loopback::start_slave(std::uint64_t session) {
  SlaveSide& s = *slave_;
  s.slave.emplace(slave_config(scene_.proto));
  s.link.emplace(link_config(scene_, session));
  s.phase.emplace(s.loop.period, s.clock.local(now_) + s.loop.period);
  s.ticked_sequence = 0;
  s.arrival.reset();
}

void Loopback::run() {
  run_until(end_);
}

void Loopback::run_until(TimePoint until) {
  for (;;) {
    const TimePoint at = next_event();
    if (at >= until) break;
    now_ = at;
    if (slave_) {
      deliver();
      turn_slave();
    }
    turn_master();
  }
  now_ = std::max(now_, until);
}

TimePoint Loopback::next_event() const noexcept {
  TimePoint at = up(Side::master) ? master_due() : std::min(outage_.until, next_idle_);
  if (slave_) {
    at = std::min(at, up(Side::slave) ? slave_due() : slave_->outage.until);
    if (const auto due = slave_->to_slave.next_due()) at = std::min(at, *due);
    if (const auto due = slave_->to_master.next_due()) at = std::min(at, *due);
  }
  return std::max(at, now_);
}

TimePoint Loopback::master_due() const noexcept {
  return clock_.truth(cut_off_ ? *cut_off_ : next_sample_);
}

TimePoint Loopback::slave_due() const noexcept {
  const SlaveSide& s = *slave_;
  return s.clock.truth(s.socket.empty() ? s.phase->due(s.arrival) : s.phase->earliest());
}

void Loopback::turn_master() {
  if (!up(Side::master)) return idle_device();
  if (outage_.session) {
    start_master(*outage_.session);
    outage_.session.reset();
  }
  const TimePoint now = clock_.local(now_);
  if (cut_off_ && (answered() || *cut_off_ <= now)) actuate();
  if (next_sample_ <= now && !cut_off_) sample();
}

void Loopback::turn_slave() {
  if (!up(Side::slave)) return;
  SlaveSide& s = *slave_;
  if (s.outage.session) {
    start_slave(*s.outage.session);
    s.outage.session.reset();
  }
  // As in SlaveLoop::await_message: a burst, and more while it waits anyway.
  const TimePoint now = s.clock.local(now_);
  if (now < s.phase->earliest()) return;
  do {
    s.socket.take_burst([&](auto d) { receive(Side::slave, d); });
    note_arrival();
  } while (!s.socket.empty() && s.phase->due(s.arrival) > now);
  if (s.phase->due(s.arrival) <= now) slave_tick();
}

void Loopback::deliver() {
  for (auto d = slave_->to_slave.pop(now_, buffer_); !d.empty();
       d = slave_->to_slave.pop(now_, buffer_))
    arrive(Side::slave, d);
  for (auto d = slave_->to_master.pop(now_, buffer_); !d.empty();
       d = slave_->to_master.pop(now_, buffer_))
    arrive(Side::master, d);
  note_arrival();
}

void Loopback::arrive(Side to, std::span<const std::byte> datagram) {
  if (outage(to).session) return;  // nobody is there
  SocketQueue& socket = to == Side::master ? socket_ : slave_->socket;
  if (up(to) && socket.empty()) return receive(to, datagram);
  socket.push(datagram);
}

void Loopback::receive(Side to, std::span<const std::byte> datagram) noexcept {
  const auto opened = on_arrival ? on_arrival(to, datagram) : datagram;
  const TimePoint now = clock(to).local(now_);
  const auto taken = [&](auto& link) {
    return !opened.empty() && link.receive(opened, now) == Verdict::accepted;
  };
  on_received(to, datagram, to == Side::master ? taken(*link_) : taken(*slave_->link));
  if (to == Side::slave && !opened.empty()) push(Side::master, slave_->link->answer());
}

void Loopback::note_arrival() noexcept {
  const auto* newest = slave_->link->newest();
  if (newest != nullptr && newest->sequence != slave_->ticked_sequence)
    slave_->arrival = newest->received;
}

void Loopback::slave_tick() {
  SlaveSide& s = *slave_;
  const TimePoint now = s.clock.local(now_);
  RobotReading reading = s.unplugged ? RobotReading{} : read(s.robot, now_);
  on_robot(reading);
  const SlaveTick& tick =
      s.slave->tick(now, peer<MasterToSlave>(*s.link, now, s.loop.lost), reading);
  if (!s.unplugged) write(s.robot, now_, tick.tau);
  push(Side::master, s.link->hello_due(now));
  if (tick.answers) push(Side::master, s.link->encode(tick.out, now));
  s.phase->ticked(now, s.arrival);
  s.arrival.reset();
  if (s.link->newest() != nullptr) s.ticked_sequence = s.link->newest()->sequence;
  on_slave(tick);
}

void Loopback::sample() {
  const TimePoint now = clock_.local(now_);
  HandleReading reading = read(device_, now_);
  if (unplugged_) reading = {};
  on_reading(reading);
  const MasterToSlave& message =
      master_->sample(now, reading, peer<SlaveToMaster>(*link_, now, loop_.lost));
  next_sample_ += loop_.period;
  cut_off_ = now;
  if (!slave_) return;
  push(Side::slave, link_->hello_due(now));
  push(Side::slave, link_->encode(message, now));
  sent_sequence_ = link_->sequence();
  cut_off_ = now + loop_.cut_off;
  // As in MasterLoop::await_answer: it reads on while it waits.
  while (!socket_.empty() && !answered())
    socket_.take_burst([&](auto d) { receive(Side::master, d); });
}

void Loopback::actuate() {
  const TimePoint now = clock_.local(now_);
  cut_off_.reset();
  const MasterTick& tick = master_->actuate(now, peer<SlaveToMaster>(*link_, now, loop_.lost));
  unplugged_ ? let_go() : write(device_, now_, tick.tau);
  if (now > next_sample_) next_sample_ += (now - next_sample_) / loop_.period * loop_.period;
  on_master(tick);
}

bool Loopback::answered() const noexcept {
  return slave_ && link_->newest() != nullptr && link_->newest()->echo_sequence >= sent_sequence_ &&
         sent_sequence_ > 0;
}

}  // namespace farhand
