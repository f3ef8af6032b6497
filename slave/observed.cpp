#include "slave/observed.hpp"

#include "common/realtime.hpp"
#include "proto/observe.pb.h"

namespace farhand {
namespace {

std::string shown(const SlaveRecord& r, std::uint64_t scene_hash) {
  const SlaveTick& t = r.tick;
  proto::Shown s;
  s.set_protocol_version(kProtocolVersion);
  s.set_scene_hash(scene_hash);
  s.set_mode(static_cast<std::uint32_t>(t.mode));
  s.set_reason(static_cast<std::uint32_t>(t.reason));
  s.set_coupled(t.coupled);
  s.set_limits(t.limits);
  for (const double x : t.X_SE.p) s.add_position_tool_in_slave_m(x);
  const Quat q(t.X_SE.R);
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) s.add_orientation_tool_in_slave_wxyz(x);
  for (const double x : t.F_E_S.force) s.add_force_on_environment_newton(x);
  for (const double x : t.F_E_S.torque) s.add_torque_on_environment_newton_m(x);
  s.set_jitter_us(1e6 * seconds(r.link.jitter));
  s.set_received(r.link.received);
  s.set_dropped(r.link.dropped);
  s.set_lost(r.link.lost);
  return s.SerializeAsString();
}

}  // namespace

ObservedSlave::ObservedSlave(const UdpAddress& local, const std::optional<Credentials>& credentials,
                             std::uint64_t scene_hash)
    : socket_(local),
      observers_(credentials, [this](std::span<const std::byte> d,
                                     const UdpAddress& to) { socket_.send_to(d, to); }),
      scene_hash_(scene_hash) {}

// No more than a burst at a time: a flood of questions must not hold up the records.
void ObservedSlave::add(const SlaveRecord& record) {
  constexpr Duration kPause = std::chrono::milliseconds(20);
  constexpr int kBurst = 64;
  if (record.tick.now < next_) return;
  next_ = record.tick.now + kPause;
  observers_.show(shown(record, scene_hash_));
  const TimePoint now = monotonic_now();
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer;
  for (int i = 0; i < kBurst; ++i) {
    const auto got = socket_.receive(buffer);
    if (!got) break;
    observers_.receive(std::span(buffer).first(got->size), got->from, now);
  }
  observers_.tick(now);
}

}  // namespace farhand
