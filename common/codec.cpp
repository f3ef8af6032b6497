#include "common/codec.hpp"

#include <algorithm>
#include <cmath>

#include "proto/wire.pb.h"

namespace farhand {
namespace {

// A longer payload is not worth parsing.
constexpr std::size_t kLongestMessageBytes =
    std::max(kMasterToSlaveBytes + kUserWrenchBytes + kFeltBytes + kWaveBytes,
             kSlaveToMasterBytes + kRobotBytes + kWallBytes + kWaveBytes + kActedBytes);

using Doubles = google::protobuf::RepeatedField<double>;

static_assert(static_cast<int>(Mode::disconnected) == proto::MODE_DISCONNECTED &&
              static_cast<int>(Mode::holding) == proto::MODE_HOLDING &&
              static_cast<int>(Mode::stopped) == proto::Mode_MAX &&
              proto::Mode_ARRAYSIZE == kModes);
static_assert(static_cast<int>(Reason::silent) == proto::REASON_SILENT &&
              static_cast<int>(Reason::no_attitude) == proto::Reason_MAX &&
              proto::Reason_ARRAYSIZE == kReasons);
static_assert(static_cast<int>(Method::damped) == proto::METHOD_DAMPED &&
              static_cast<int>(Method::mmt) == proto::Method_MAX &&
              proto::Method_ARRAYSIZE == kMethods);
static_assert(static_cast<int>(Role::master) == proto::ROLE_MASTER &&
              static_cast<int>(Role::slave) == proto::Role_MAX);
static_assert(static_cast<int>(Lease::held) == proto::LEASE_HELD &&
              static_cast<int>(Lease::lost) == proto::Lease_MAX);

template <typename Column>
void put(const Column& from, Doubles* to) {
  to->Resize(static_cast<int>(from.size()), 0);
  for (int i = 0; i < to->size(); ++i) to->Set(i, from[i]);
}

// False if the array has another length.
template <typename Column>
bool get(const Doubles& from, Column& to) {
  if (from.size() != to.size()) return false;
  for (int i = 0; i < from.size(); ++i) to[i] = from[i];
  return true;
}

// What a message has only in some scenes: left out, it takes no room and reads as zero.
template <typename Column>
void put_if(bool present, const Column& from, Doubles* to) {
  present ? put(from, to) : to->Clear();
}
template <typename Column>
bool get_if(bool present, const Doubles& from, Column& to) {
  if (present) return get(from, to);
  if constexpr (std::is_same_v<Column, Vec3>) to.setZero();
  return from.empty();
}

using Vec4 = Eigen::Vector4d;
Vec4 wxyz(const Quat& q) noexcept {
  return {q.w(), q.x(), q.y(), q.z()};
}

void put(const Header& from, proto::Header* to) {
  to->set_session(from.session);
  to->set_peer_session(from.peer_session);
  to->set_sequence(from.sequence);
  to->set_sent_ns(from.sent);
  to->set_echo_sequence(from.echo_sequence);
  to->set_echo_sent_ns(from.echo_sent);
  to->set_echo_hold_ns(from.echo_hold);
}

Header get(const proto::Header& from) noexcept {
  return {.session = from.session(),
          .peer_session = from.peer_session(),
          .sequence = from.sequence(),
          .sent = from.sent_ns(),
          .echo_sequence = from.echo_sequence(),
          .echo_sent = from.echo_sent_ns(),
          .echo_hold = from.echo_hold_ns()};
}

void put(const Hello& from, proto::Hello& to) {
  to.set_protocol_version(from.protocol_version);
  to.set_role(static_cast<proto::Role>(from.role));
  to.set_session(from.session);
  to.set_scene_hash(from.scene_hash);
  to.set_take_over(from.take_over);
  to.set_peer_session(from.peer_session);
  to.set_lease(static_cast<proto::Lease>(from.lease));
  to.set_leases(from.leases);
}

void put(const WaveSum& from, proto::Wave* to) {
  put(from.U, to->mutable_integral());
  to->set_energy_joule(from.E);
}

bool get(const proto::Wave& from, WaveSum& to) {
  to.E = from.energy_joule();
  return get(from.integral(), to.U);
}

// The block of a message that has one, else zero.
template <typename Proto>
bool get_wave(const Proto& from, bool& has_wave, WaveSum& to) {
  has_wave = from.has_wave();
  to = {};
  return !has_wave || get(from.wave(), to);
}

void put(const MasterToSlave& from, proto::MasterToSlave& to) {
  put(from.p_MH, to.mutable_position_handle_in_master_m());
  put(wxyz(from.q_MH), to.mutable_orientation_handle_in_master_wxyz());
  put(from.V_MH.angular, to.mutable_angular_velocity_handle_in_master_rad_per_s());
  put(from.V_MH.linear, to.mutable_velocity_handle_in_master_m_per_s());
  to.set_mode(static_cast<proto::Mode>(from.mode));
  to.set_reason(static_cast<proto::Reason>(from.reason));
  to.set_dead_man(from.dead_man);
  to.set_clutch(from.clutch);
  to.set_force_wanted(from.force_wanted);
  to.set_dead_man_presses(from.dead_man_presses);
  to.set_clutch_presses(from.clutch_presses);
  to.set_method(static_cast<proto::Method>(from.method));
  to.set_translation_energy_joule(from.energies.translation);
  to.set_rotation_energy_joule(from.energies.rotation);
  put_if(from.has_user_wrench, from.F_user_M.force, to.mutable_user_force_in_master_newton());
  put_if(from.has_user_wrench, from.F_user_M.torque, to.mutable_user_torque_in_master_newton_m());
  put_if(from.has_felt, from.F_felt_M, to.mutable_felt_force_in_master_newton());
  from.has_wave ? put(from.wave, to.mutable_wave()) : to.clear_wave();
}

bool get(const proto::MasterToSlave& from, MasterToSlave& to) {
  Vec4 q;
  if (!get(from.position_handle_in_master_m(), to.p_MH) ||
      !get(from.orientation_handle_in_master_wxyz(), q) ||
      !get(from.angular_velocity_handle_in_master_rad_per_s(), to.V_MH.angular) ||
      !get(from.velocity_handle_in_master_m_per_s(), to.V_MH.linear))
    return false;
  to.q_MH = Quat(q[0], q[1], q[2], q[3]);
  to.mode = static_cast<Mode>(from.mode());
  to.reason = static_cast<Reason>(from.reason());
  to.dead_man = from.dead_man();
  to.clutch = from.clutch();
  to.force_wanted = from.force_wanted();
  to.dead_man_presses = from.dead_man_presses();
  to.clutch_presses = from.clutch_presses();
  to.method = static_cast<Method>(from.method());
  to.energies.translation = from.translation_energy_joule();
  to.energies.rotation = from.rotation_energy_joule();
  to.has_user_wrench = from.user_force_in_master_newton_size() > 0;
  to.has_felt = from.felt_force_in_master_newton_size() > 0;
  return get_wave(from, to.has_wave, to.wave) &&
         get_if(to.has_felt, from.felt_force_in_master_newton(), to.F_felt_M) &&
         get_if(to.has_user_wrench, from.user_force_in_master_newton(), to.F_user_M.force) &&
         get_if(to.has_user_wrench, from.user_torque_in_master_newton_m(), to.F_user_M.torque);
}

void put(const LocalWall& from, proto::Wall* to) {
  put(from.x_w, to->mutable_point_in_master_m());
  put(from.n, to->mutable_normal_in_master());
  to->set_stiffness_newton_per_m(from.k);
  to->set_damping_newton_s_per_m(from.b);
  to->set_energy_joule(from.net);
  to->set_contacts(from.contacts);
  to->set_known(from.known);
  to->set_sure(from.sure);
}

bool get(const proto::Wall& from, LocalWall& to) {
  to.k = from.stiffness_newton_per_m();
  to.b = from.damping_newton_s_per_m();
  to.net = from.energy_joule();
  to.contacts = from.contacts();
  to.known = from.known();
  to.sure = from.sure();
  return get(from.point_in_master_m(), to.x_w) && get(from.normal_in_master(), to.n);
}

void put(const SlaveToMaster& from, proto::SlaveToMaster& to) {
  put(from.p_SE, to.mutable_position_tool_in_slave_m());
  put(wxyz(from.q_SE), to.mutable_orientation_tool_in_slave_wxyz());
  put(from.V_SE.angular, to.mutable_angular_velocity_tool_in_slave_rad_per_s());
  put(from.V_SE.linear, to.mutable_velocity_tool_in_slave_m_per_s());
  put(from.F_E_M.force, to.mutable_force_on_environment_in_master_newton());
  put(from.F_E_M.torque, to.mutable_torque_on_environment_in_master_newton_m());
  to.set_mode(static_cast<proto::Mode>(from.mode));
  to.set_reason(static_cast<proto::Reason>(from.reason));
  to.set_coupled(from.coupled);
  to.set_limits(from.limits);
  to.set_dead_man_presses_seen(from.dead_man_presses_seen);
  to.set_clutch_presses_seen(from.clutch_presses_seen);
  to.set_translation_energy_joule(from.energies.translation);
  to.set_rotation_energy_joule(from.energies.rotation);
  put_if(from.has_robot, from.p_MR, to.mutable_position_robot_in_master_m());
  put_if(from.has_robot, wxyz(from.q_MR), to.mutable_orientation_robot_in_master_wxyz());
  put_if(from.has_robot, from.V_MR.angular,
         to.mutable_angular_velocity_robot_in_master_rad_per_s());
  put_if(from.has_robot, from.V_MR.linear, to.mutable_velocity_robot_in_master_m_per_s());
  from.has_wall ? put(from.wall, to.mutable_wall()) : to.clear_wall();
  from.has_wave ? put(from.wave, to.mutable_wave()) : to.clear_wave();
  from.has_acted ? to.set_acted_ns(from.acted) : to.clear_acted_ns();
}

bool get_robot(const proto::SlaveToMaster& from, SlaveToMaster& to) {
  to.has_robot = from.position_robot_in_master_m_size() > 0;
  Vec4 q = wxyz(Quat::Identity());
  const bool good =
      get_if(to.has_robot, from.position_robot_in_master_m(), to.p_MR) &&
      get_if(to.has_robot, from.orientation_robot_in_master_wxyz(), q) &&
      get_if(to.has_robot, from.angular_velocity_robot_in_master_rad_per_s(), to.V_MR.angular) &&
      get_if(to.has_robot, from.velocity_robot_in_master_m_per_s(), to.V_MR.linear);
  to.q_MR = Quat(q[0], q[1], q[2], q[3]);
  return good;
}

bool get(const proto::SlaveToMaster& from, SlaveToMaster& to) {
  Vec4 q;
  if (!get(from.position_tool_in_slave_m(), to.p_SE) ||
      !get(from.orientation_tool_in_slave_wxyz(), q) ||
      !get(from.angular_velocity_tool_in_slave_rad_per_s(), to.V_SE.angular) ||
      !get(from.velocity_tool_in_slave_m_per_s(), to.V_SE.linear) ||
      !get(from.force_on_environment_in_master_newton(), to.F_E_M.force) ||
      !get(from.torque_on_environment_in_master_newton_m(), to.F_E_M.torque))
    return false;
  to.q_SE = Quat(q[0], q[1], q[2], q[3]);
  to.mode = static_cast<Mode>(from.mode());
  to.reason = static_cast<Reason>(from.reason());
  to.coupled = from.coupled();
  to.limits = from.limits();
  to.dead_man_presses_seen = from.dead_man_presses_seen();
  to.clutch_presses_seen = from.clutch_presses_seen();
  to.energies.translation = from.translation_energy_joule();
  to.energies.rotation = from.rotation_energy_joule();
  to.has_wall = from.has_wall();
  if (!to.has_wall) to.wall = {};
  to.has_acted = from.has_acted_ns();
  to.acted = from.acted_ns();
  return get_robot(from, to) && (!to.has_wall || get(from.wall(), to.wall)) &&
         get_wave(from, to.has_wave, to.wave);
}

std::size_t size_of(const MasterToSlave& m) noexcept {
  return kMasterToSlaveBytes + (m.has_user_wrench ? kUserWrenchBytes : 0) +
         (m.has_felt ? kFeltBytes : 0) + (m.has_wave ? kWaveBytes : 0);
}
std::size_t size_of(const SlaveToMaster& m) noexcept {
  return kSlaveToMasterBytes + (m.has_robot ? kRobotBytes : 0) + (m.has_wall ? kWallBytes : 0) +
         (m.has_wave ? kWaveBytes : 0) + (m.has_acted ? kActedBytes : 0);
}

template <typename Proto>
std::size_t serialise(PayloadType type, const Proto& message, std::size_t size,
                      std::span<std::byte> payload) noexcept {
  if (message.ByteSizeLong() + 1 != size || payload.size() < size) return 0;
  payload[0] = static_cast<std::byte>(type);
  message.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(&payload[1]));
  return size;
}

bool is(PayloadType type, std::span<const std::byte> payload) noexcept {
  return !payload.empty() && payload[0] == static_cast<std::byte>(type);
}

// Partial: protobuf's own check of required fields would log.
template <typename Proto>
bool parse(std::span<const std::byte> payload, Proto& message) noexcept {
  return message.ParsePartialFromArray(&payload[0] + 1, static_cast<int>(payload.size() - 1));
}

template <typename Proto, typename Message>
std::size_t encode_with(PayloadType type, const Header& header, const Message& message,
                        Proto& reused, std::span<std::byte> payload) noexcept {
  if (!valid(header) || !valid(message)) return 0;
  put(header, reused.mutable_header());
  put(message, reused);
  return serialise(type, reused, size_of(message), payload);
}

template <typename Proto, typename Message>
Verdict decode_with(PayloadType type, std::span<const std::byte> payload, Proto& reused,
                    Header& header, Message& message) noexcept {
  if (!is(type, payload)) return Verdict::unexpected_type;
  if (payload.size() > kLongestMessageBytes || !parse(payload, reused) || !reused.IsInitialized() ||
      !get(reused, message) || payload.size() != size_of(message))
    return Verdict::malformed;
  header = get(reused.header());
  return valid(header) && valid(message) ? Verdict::accepted : Verdict::malformed;
}

}  // namespace

struct Codec::Messages {
  proto::Hello hello;
  proto::MasterToSlave master_to_slave;
  proto::SlaveToMaster slave_to_master;
};

// One round through both messages at their longest leaves every array and sub-message with room for
// the next.
Codec::Codec() : messages_(std::make_unique<Messages>()) {
  std::array<std::byte, kMaxPayloadBytes> payload{};
  Header header{.session = 1, .sequence = 1};
  MasterToSlave down{.has_user_wrench = true, .has_felt = true, .has_wave = true};
  SlaveToMaster up{.has_robot = true, .has_wall = true, .has_wave = true, .has_acted = true};
  decode(std::span(payload).first(encode(header, down, payload)), header, down);
  decode(std::span(payload).first(encode(header, up, payload)), header, up);
}

Codec::~Codec() = default;

std::size_t Codec::encode(const Hello& hello, std::span<std::byte> payload) noexcept {
  if (!valid(hello)) return 0;
  put(hello, messages_->hello);
  return serialise(PayloadType::hello, messages_->hello, kHelloBytes, payload);
}

std::size_t Codec::encode(const Header& header, const MasterToSlave& message,
                          std::span<std::byte> payload) noexcept {
  return encode_with(PayloadType::master_to_slave, header, message, messages_->master_to_slave,
                     payload);
}

std::size_t Codec::encode(const Header& header, const SlaveToMaster& message,
                          std::span<std::byte> payload) noexcept {
  return encode_with(PayloadType::slave_to_master, header, message, messages_->slave_to_master,
                     payload);
}

Verdict Codec::decode(std::span<const std::byte> payload, Hello& hello) noexcept {
  if (!is(PayloadType::hello, payload)) return Verdict::unexpected_type;
  proto::Hello& from = messages_->hello;
  if (!parse(payload, from) || !from.has_protocol_version()) return Verdict::malformed;
  hello = {.protocol_version = from.protocol_version()};
  if (hello.protocol_version != kProtocolVersion) return Verdict::wrong_version;
  if (payload.size() != kHelloBytes || !from.IsInitialized()) return Verdict::malformed;
  hello.role = static_cast<Role>(from.role());
  hello.session = from.session();
  hello.scene_hash = from.scene_hash();
  hello.take_over = from.take_over();
  hello.peer_session = from.peer_session();
  hello.lease = static_cast<Lease>(from.lease());
  hello.leases = from.leases();
  return valid(hello) ? Verdict::accepted : Verdict::malformed;
}

Verdict Codec::decode(std::span<const std::byte> payload, Header& header,
                      MasterToSlave& message) noexcept {
  return decode_with(PayloadType::master_to_slave, payload, messages_->master_to_slave, header,
                     message);
}

Verdict Codec::decode(std::span<const std::byte> payload, Header& header,
                      SlaveToMaster& message) noexcept {
  return decode_with(PayloadType::slave_to_master, payload, messages_->slave_to_master, header,
                     message);
}

}  // namespace farhand
