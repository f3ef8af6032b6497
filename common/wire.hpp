// The protocol in one place: what the two sides tell each other as plain values, and every number
// both must agree on. proto/wire.proto gives the bytes of a message, common/channel.hpp the frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/geometry.hpp"
#include "common/local_wall.hpp"
#include "common/method.hpp"
#include "common/mode.hpp"
#include "common/ports.hpp"
#include "common/wave_sum.hpp"

namespace farhand {

inline constexpr std::uint32_t kProtocolVersion =
    5;                                               // changes with any byte below or in wire.proto
inline constexpr std::uint32_t kMagic = 0x314c4846;  // "FHL1", little endian like every number
inline constexpr std::size_t kMaxDatagramBytes = 1200;  // below any path's MTU: never fragmented
inline constexpr std::size_t kChannelHeaderBytes = 6;   // magic, payload length
inline constexpr std::size_t kChannelTrailerBytes = 4;  // CRC-32C of all before it
inline constexpr std::size_t kDtlsHeaderBytes = 13;     // type, version, epoch, sequence, length
inline constexpr std::size_t kDtlsTagBytes = 16;        // Poly1305
inline constexpr std::size_t kMaxPayloadBytes =
    kMaxDatagramBytes - kDtlsHeaderBytes - kDtlsTagBytes;  // fits the plain frame too

// Payload sizes, type byte included. A payload of another size is refused.
inline constexpr std::size_t kHelloBytes = 44;
inline constexpr std::size_t kMasterToSlaveBytes = 220;
inline constexpr std::size_t kSlaveToMasterBytes = 269;
// More with what only some bilateral architectures and compensations send.
inline constexpr std::size_t kUserWrenchBytes = 52;
inline constexpr std::size_t kFeltBytes = 27;
inline constexpr std::size_t kRobotBytes = 116;
inline constexpr std::size_t kWallBytes = 91;
inline constexpr std::size_t kWaveBytes = 38;
inline constexpr std::size_t kActedBytes = 10;

inline constexpr double kQuaternionTolerance = 1e-6;  // on the norm
inline constexpr std::uint64_t kMaxStamp = std::uint64_t{1}
                                           << 60;  // [ns], 36 years: sums cannot overflow

// First byte of a payload.
enum class PayloadType : std::uint8_t { hello = 1, master_to_slave = 2, slave_to_master = 3 };

enum class Role : std::uint8_t { master, slave };

// What a slave says a master has: one of them leads it.
enum class Lease : std::uint8_t {
  none,     // nobody was heard yet
  held,     // it leads
  refused,  // another one leads
  lost,     // it led, or asked to, and another one took its place for good
};

struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  Role role = Role::master;
  std::uint64_t session = 0;  // random at each start, not 0
  std::uint64_t scene_hash = 0;
  bool take_over = false;          // a master's: lead in the place of the one that leads
  std::uint64_t peer_session = 0;  // the one it answers; 0: none
  Lease lease = Lease::none;       // a slave's, of peer_session
  std::uint32_t leases = 0;        // a slave's: how many it gave so far, which tells old news
};

// In front of every message. Stamps are the sender's monotonic clock in ns, at most kMaxStamp.
struct Header {
  std::uint64_t session = 0;       // the sender's
  std::uint64_t peer_session = 0;  // the one it answers
  std::uint64_t sequence = 0;      // from 1
  std::uint64_t sent = 0;
  std::uint64_t echo_sequence = 0;  // newest one received from the peer; 0: none yet
  std::uint64_t echo_sent = 0;      // its stamp, on the peer's clock
  std::uint64_t echo_hold = 0;      // from its arrival to `sent`
};

// Absolute state and cumulative counts only, so that a lost datagram costs nothing but age.
struct MasterToSlave {
  Vec3 p_MH = Vec3::Zero();      // [m]
  Quat q_MH = Quat::Identity();  // unit to kQuaternionTolerance
  Twist V_MH;                    // of H relative to M, at H, M axes
  Mode mode = Mode::disconnected;
  Reason reason = Reason::no_partner;  // for the mode
  bool dead_man = false;               // held right now
  bool clutch = false;                 // held right now
  bool force_wanted = false;           // the wrench is of use
  std::uint32_t dead_man_presses = 0;  // edges since the session began: none is missed by a loss
  std::uint32_t clutch_presses = 0;
  Method method = Method::direct;  // by which the robot shall follow
  PortEnergies energies;           // of the master's port; 0 without a compensation that guards it
  bool has_user_wrench = false;
  Wrench F_user_M;  // user on handle at H, M axes
  bool has_felt = false;
  Vec3 F_felt_M = Vec3::Zero();  // handle on what it is coupled to, M axes [N]
  bool has_wave = false;
  WaveSum wave;  // M axes
};

struct SlaveToMaster {
  Vec3 p_SE = Vec3::Zero();      // [m]
  Quat q_SE = Quat::Identity();  // unit to kQuaternionTolerance
  Twist V_SE;                    // of E relative to S, at E, S axes
  Wrench F_E_M;                  // robot on environment at E, mapped into M axes and scaled
  Mode mode = Mode::disconnected;
  Reason reason = Reason::no_partner;  // for the mode
  bool coupled = false;                // the robot follows the handle right now
  std::uint32_t limits = 0;            // bit set: what holds the robot back (common/limits.hpp)
  std::uint32_t dead_man_presses_seen = 0;  // counts acted upon: the receipt for the master's edges
  std::uint32_t clutch_presses_seen = 0;
  PortEnergies energies;  // of the slave's port
  // The robot as a handle: while `coupled`, where the architecture needs it, the pose and velocity
  // of H that mean where the tool is. Uncoupled, where the scene has alignment_deg and the robot
  // was coupled before: the orientation that H must be turned to, position and velocity zero.
  bool has_robot = false;
  Vec3 p_MR = Vec3::Zero();
  Quat q_MR = Quat::Identity();  // unit to kQuaternionTolerance
  Twist V_MR;
  bool has_wall = false;
  LocalWall wall;  // M axes, in the handle's terms
  bool has_wave = false;
  WaveSum wave;  // M axes
  bool has_acted = false;
  std::uint64_t acted = 0;  // Header::sent of the pose that F_E_M answers, on the master's clock
};

// What became of a received datagram, in the order of the checks.
enum class Verdict : std::uint8_t {
  accepted,
  too_short,        // no room for a frame with a payload
  too_long,         // above kMaxDatagramBytes
  bad_magic,        // not ours
  bad_length,       // cut off or extended
  bad_checksum,     // changed on the way
  wrong_content,    // a record of DTLS, but none of data
  wrong_epoch,      // a record from before the handshake's end
  not_connected,    // a sealed record, and no secure connection stands
  not_authentic,    // forged, changed, of another connection, or seen before
  unexpected_type,  // no such payload
  wrong_role,       // from a side like ourselves
  malformed,        // size, missing field, array length, not finite, not a rotation, unknown value
  wrong_version,    // hello of another protocol version
  wrong_scene,      // hello of a peer started with another scene
  leased,           // hello of one master while another leads, or the slave's answer to that
  foreign_session,  // not, or no longer, the session of our peer
  other_recipient,  // from our peer, answering a session that is not ours
  bad_echo,         // echoes what we have not sent
  duplicate,        // seen before
  older,            // a newer one is here already
  too_late,         // far longer on its way than the fastest
};
inline constexpr std::size_t kVerdicts = static_cast<std::size_t>(Verdict::too_late) + 1;

constexpr const char* to_string(Verdict v) noexcept {
  constexpr std::array<const char*, kVerdicts> kNames = {
      "accepted",        "too short",       "too long",        "bad magic",     "bad length",
      "bad checksum",    "wrong content",   "wrong epoch",     "not connected", "not authentic",
      "unexpected type", "wrong role",      "malformed",       "wrong version", "wrong scene",
      "leased",          "foreign session", "other recipient", "bad echo",      "duplicate",
      "older",           "too late"};
  return kNames[static_cast<std::size_t>(v)];
}

}  // namespace farhand
