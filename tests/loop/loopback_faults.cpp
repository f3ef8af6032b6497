// What goes wrong in a Loopback because a test says so.
#include <algorithm>

#include "tests/loop/loopback.hpp"

namespace farhand {

const Loopback::Outage& Loopback::outage(Side side) const noexcept {
  return side == Side::master ? outage_ : slave_->outage;
}

// A later one never ends an earlier one early, and a process that is to start does start.
void Loopback::interrupt(Side side, const Outage& with) {
  Outage& o = side == Side::master ? outage_ : slave_->outage;
  const bool was_up = up(side);
  if (side == Side::master && was_up) next_idle_ = now_;
  if (was_up) o.since = now_;
  o.until = std::max(o.until, with.until);
  if (with.session) o.session = with.session;
}

void Loopback::stall(Side side, Duration length) {
  interrupt(side, {.until = now_ + length});
}

void Loopback::restart(Side side, Duration length, std::uint64_t session) {
  interrupt(side, {.until = now_ + length, .session = session});
  (side == Side::master ? socket_ : slave_->socket).clear();
}

void Loopback::step_clock(Side side, Duration forward) noexcept {
  (side == Side::master ? clock_ : slave_->clock).step(now_, forward);
}

void Loopback::unplug(Side side, bool on) noexcept {
  if (side == Side::slave) slave_->unplugged = on;
  if (side == Side::master && on != unplugged_.has_value())
    unplugged_ = on ? std::optional(now_) : std::nullopt;
}

void Loopback::turn_hand(const Vec3& rate) noexcept {
  std::visit(
      [&](auto& d) {
        if constexpr (requires { d.turn(rate); }) d.turn(rate);
      },
      device_);
}

void Loopback::change_network(const std::optional<ImpairmentConfig>& to_slave,
                              const std::optional<ImpairmentConfig>& to_master) {
  slave_->to_slave.change(to_slave);
  slave_->to_master.change(to_master);
}

void Loopback::push(Side to, std::span<const std::byte> datagram) noexcept {
  if (datagram.empty()) return;
  if (on_send) datagram = on_send(to == Side::master ? Side::slave : Side::master, datagram);
  if (!datagram.empty()) send(to, datagram);
}

void Loopback::send(Side to, std::span<const std::byte> datagram) noexcept {
  if (cut_[static_cast<std::size_t>(to)]) return;
  on_sent(to, datagram);
  (to == Side::master ? slave_->to_master : slave_->to_slave).push(datagram, now_);
}

void Loopback::inject(Side to, std::span<const std::byte> datagram) {
  arrive(to, datagram);
  note_arrival();
}

// Nobody reads or writes the device; it goes on by itself.
void Loopback::idle_device() noexcept {
  if (now_ < next_idle_) return;
  next_idle_ = now_ + loop_.period;
  read(device_, now_);
  if (now_ - outage_.since >= kWatchdog) write(device_, now_, Vec6::Zero());
}

void Loopback::let_go() noexcept {
  if (now_ - *unplugged_ >= kWatchdog) write(device_, now_, Vec6::Zero());
}

}  // namespace farhand
