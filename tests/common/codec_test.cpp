#include "common/codec.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "proto/wire.pb.h"
#include "tests/support/allocations.hpp"
#include "tests/support/messages.hpp"

namespace farhand {
namespace {

using Payload = std::array<std::byte, kMaxPayloadBytes>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Header header(Random& random) {
  return {.session = random.bits() | 1,
          .peer_session = random.bits(),
          .sequence = random.bits() | 1,
          .sent = random.bits() % (kMaxStamp + 1),
          .echo_sequence = random.bits(),
          .echo_sent = random.bits() % (kMaxStamp + 1),
          .echo_hold = random.bits() % (kMaxStamp + 1)};
}

bool same(const Header& a, const Header& b) {
  return a.session == b.session && a.peer_session == b.peer_session && a.sequence == b.sequence &&
         a.sent == b.sent && a.echo_sequence == b.echo_sequence && a.echo_sent == b.echo_sent &&
         a.echo_hold == b.echo_hold;
}

template <typename Message>
class CodecOf : public testing::Test {};
using Messages = testing::Types<MasterToSlave, SlaveToMaster>;
TYPED_TEST_SUITE(CodecOf, Messages);

std::size_t size_of(const MasterToSlave& m) {
  return kMasterToSlaveBytes + (m.has_user_wrench ? kUserWrenchBytes : 0) +
         (m.has_felt ? kFeltBytes : 0) + (m.has_wave ? kWaveBytes : 0);
}
std::size_t size_of(const SlaveToMaster& m) {
  return kSlaveToMasterBytes + (m.has_robot ? kRobotBytes : 0) + (m.has_wall ? kWallBytes : 0) +
         (m.has_wave ? kWaveBytes : 0) + (m.has_acted ? kActedBytes : 0);
}

// What only some scenes send comes last, so some prefixes are shorter messages.
bool is_whole_without_its_end(MasterToSlave m, std::size_t n) {
  bool whole = false;
  for (bool MasterToSlave::*block : {&MasterToSlave::has_wave, &MasterToSlave::has_felt}) {
    m.*block = false;
    whole = whole || n == size_of(m);
  }
  return whole;
}
bool is_whole_without_its_end(SlaveToMaster m, std::size_t n) {
  bool whole = false;
  for (bool SlaveToMaster::*block : {&SlaveToMaster::has_acted, &SlaveToMaster::has_wave,
                                     &SlaveToMaster::has_wall, &SlaveToMaster::has_robot}) {
    m.*block = false;
    whole = whole || n == size_of(m);
  }
  return whole;
}

TYPED_TEST(CodecOf, ComesBackToTheLastBitAndInItsSize) {
  Codec codec;
  Random random(5);
  Payload payload;
  for (int i = 0; i < 10000; ++i) {
    TypeParam message, out;
    if (i > 0) randomise(random, message);  // the first: all zeros take the same room
    const Header sent = header(random);
    Header got;
    const std::size_t size = size_of(message);
    ASSERT_EQ(codec.encode(sent, message, payload), size);
    ASSERT_EQ(codec.decode(std::span(payload).first(size), got, out), Verdict::accepted) << i;
    ASSERT_TRUE(same(sent, got) && same(message, out)) << i;
  }
}

TYPED_TEST(CodecOf, TakesNothingFromTheHeap) {
  Codec codec;
  Random random(6);
  Payload payload;
  TypeParam message, out;
  Header got;
  EXPECT_EQ(allocations_in([&] {
              for (int i = 0; i < 1000; ++i) {
                randomise(random, message);
                const std::size_t size = codec.encode(header(random), message, payload);
                codec.decode(std::span(payload).first(size), got, out);
              }
            }),
            0u);
  EXPECT_TRUE(same(message, out));
  EXPECT_GT(allocations_in([] { Codec another; }), 0u);  // the counter counts
}

TYPED_TEST(CodecOf, EveryPrefixAndEveryExtensionIsRefused) {
  Codec codec;
  Random random(7);
  Payload payload{};
  TypeParam message, out;
  randomise(random, message);
  Header got;
  const std::size_t size = codec.encode(header(random), message, payload);
  for (std::size_t n = 1; n < size + 20; ++n) {
    const Verdict verdict = codec.decode(std::span(payload).first(n), got, out);
    const bool whole = n == size || is_whole_without_its_end(message, n);
    EXPECT_EQ(verdict, whole ? Verdict::accepted : Verdict::malformed) << n;
  }
  EXPECT_EQ(codec.decode({}, got, out), Verdict::unexpected_type);
}

TYPED_TEST(CodecOf, AnyChangedByteGivesAValidMessageOrARefusal) {
  Codec codec;
  Random random(8);
  Payload payload;
  TypeParam message, out;
  randomise(random, message);
  Header got;
  const std::size_t size = codec.encode(header(random), message, payload);
  int accepted = 0, refused = 0;
  for (std::size_t i = 0; i < size; ++i)
    for (unsigned value = 0; value < 256; ++value) {
      const std::byte was = std::exchange(payload[i], static_cast<std::byte>(value));
      const bool ok = codec.decode(std::span(payload).first(size), got, out) == Verdict::accepted;
      ASSERT_TRUE(!ok || (valid(got) && valid(out))) << i << " " << value;
      ++(ok ? accepted : refused);
      payload[i] = was;
    }
  EXPECT_GT(accepted, 1000);  // there is no checksum at this level
  EXPECT_GT(refused, 1000);
}

TYPED_TEST(CodecOf, AHeaderThatCannotBeIsRefusedBothWays) {
  Codec codec;
  Payload payload;
  const std::function<void(Header&)> faults[] = {
      [](Header& h) { h.session = 0; }, [](Header& h) { h.sequence = 0; },
      [](Header& h) { h.sent = kMaxStamp + 1; }, [](Header& h) { h.echo_sent = kMaxStamp + 1; },
      [](Header& h) { h.echo_hold = kMaxStamp + 1; }};
  for (const auto& fault : faults) {
    Header h{.session = 1, .sequence = 1};
    EXPECT_GT(codec.encode(h, TypeParam{}, payload), 0u);
    fault(h);
    EXPECT_EQ(codec.encode(h, TypeParam{}, payload), 0u);
  }
}

TEST(Codec, MessagesThatCannotBeAreNotSent) {
  Codec codec;
  Payload payload;
  const Header h{.session = 1, .sequence = 1};
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    const std::function<void(MasterToSlave&)> down[] = {
        [&](auto& m) { m.p_MH.z() = bad; },
        [&](auto& m) { m.q_MH.w() = bad; },
        [&](auto& m) { m.V_MH.angular.x() = bad; },
        [&](auto& m) { m.V_MH.linear.y() = bad; },
        [&](auto& m) { m.energies.translation = bad; },
        [&](auto& m) { m.energies.rotation = bad; },
        [&](auto& m) { m.F_felt_M.y() = bad; },
        [&](auto& m) { m.wave.U.x() = bad, m.has_wave = true; },
        [&](auto& m) { m.wave.E = bad, m.has_wave = true; },
        [](auto& m) { m.wave.E = -1, m.has_wave = true; },
        [](auto& m) { m.mode = static_cast<Mode>(kModes); },
        [](auto& m) { m.reason = static_cast<Reason>(kReasons); },
        [](auto& m) { m.method = static_cast<Method>(kMethods); }};
    const std::function<void(SlaveToMaster&)> up[] = {
        [&](auto& m) { m.p_SE.x() = bad; },
        [&](auto& m) { m.q_SE.z() = bad; },
        [&](auto& m) { m.V_SE.angular.z() = bad; },
        [&](auto& m) { m.V_SE.linear.x() = bad; },
        [&](auto& m) { m.F_E_M.force.y() = bad; },
        [&](auto& m) { m.F_E_M.torque.z() = bad; },
        [&](auto& m) { m.energies.translation = bad; },
        [&](auto& m) { m.energies.rotation = bad; },
        [](auto& m) { m.mode = static_cast<Mode>(200); },
        [&](auto& m) { m.wall.x_w.x() = bad, m.has_wall = true; },
        [&](auto& m) { m.wall.n.x() = bad, m.has_wall = true; },
        [&](auto& m) { m.wall.k = bad, m.has_wall = true; },
        [&](auto& m) { m.wall.b = bad, m.has_wall = true; },
        [&](auto& m) { m.wall.net = bad, m.has_wall = true; },
        [](auto& m) { m.wall.k = -1, m.has_wall = true; },
        [&](auto& m) { m.wave.U.z() = bad, m.has_wave = true; },
        [&](auto& m) { m.wave.E = bad, m.has_wave = true; },
        [](auto& m) { m.acted = kMaxStamp + 1, m.has_acted = true; },
        [](auto& m) { m.wall.known = m.has_wall = true; }};  // without a normal
    for (const auto& fault : down) {
      MasterToSlave m;
      fault(m);
      EXPECT_EQ(codec.encode(h, m, payload), 0u);
    }
    for (const auto& fault : up) {
      SlaveToMaster m;
      fault(m);
      EXPECT_EQ(codec.encode(h, m, payload), 0u);
    }
  }
}

TEST(Codec, AQuaternionMayBeOffUnitNormByTheToleranceOnly) {
  Codec codec;
  Payload payload;
  const Header h{.session = 1, .sequence = 1};
  for (const auto& [norm, good] : {std::pair{1 + 0.9e-6, true},
                                   {1 - 0.9e-6, true},
                                   {1 + 1.1e-6, false},
                                   {1 - 1.1e-6, false},
                                   {0.0, false}}) {
    MasterToSlave m;
    m.q_MH.coeffs() = Eigen::Vector4d(0.5, -0.5, 0.5, -0.5) * norm;
    EXPECT_EQ(codec.encode(h, m, payload) > 0, good) << norm;
  }
}

// What a well-meaning peer cannot have sent, written with protobuf itself.
class Foreign : public testing::Test {
 protected:
  Foreign() {
    std::array<std::byte, kMaxPayloadBytes> payload;
    const std::size_t size = codec.encode(
        {.session = 1, .sequence = 1},
        MasterToSlave{.has_user_wrench = true, .has_felt = true, .has_wave = true}, payload);
    EXPECT_TRUE(message.ParseFromArray(&payload[1], static_cast<int>(size - 1)));
  }
  Verdict decoded() {
    std::string bytes(1, static_cast<char>(PayloadType::master_to_slave));
    message.AppendPartialToString(&bytes);
    Header h;
    MasterToSlave m;
    return codec.decode(std::as_bytes(std::span(bytes)), h, m);
  }
  Codec codec;
  proto::MasterToSlave message;
};

TEST_F(Foreign, TheUnchangedMessageIsAccepted) {
  EXPECT_EQ(decoded(), Verdict::accepted);
}

TEST_F(Foreign, AMessageWithoutOneOfItsFieldsIsMalformed) {
  const auto* descriptor = message.GetDescriptor();
  const proto::MasterToSlave whole = message;
  for (int i = 0; i < descriptor->field_count(); ++i) {
    const std::string& name = descriptor->field(i)->name();
    if (name == "felt_force_in_master_newton" || name == "wave") continue;  // blocks alone
    message = whole;
    message.GetReflection()->ClearField(&message, descriptor->field(i));
    EXPECT_EQ(decoded(), Verdict::malformed) << descriptor->field(i)->name();
  }
}

TEST_F(Foreign, AFieldMoreForAFieldLessIsMalformedThoughTheSizeIsRight) {
  message.clear_translation_energy_joule();
  message.mutable_unknown_fields()->AddFixed64(9, 1);  // as many bytes, under the number of a bool
  EXPECT_EQ(decoded(), Verdict::malformed);
}

TEST_F(Foreign, AnArrayOfAnotherLengthIsMalformedThoughTheSizeIsRight) {
  message.mutable_position_handle_in_master_m()->Add(0);
  message.mutable_velocity_handle_in_master_m_per_s()->Truncate(2);
  EXPECT_EQ(decoded(), Verdict::malformed);
}

TEST_F(Foreign, NumbersThatAreNoneAreMalformed) {
  message.set_position_handle_in_master_m(1, kNan);
  EXPECT_EQ(decoded(), Verdict::malformed);
  message.set_position_handle_in_master_m(1, 0);
  message.set_rotation_energy_joule(kInfinity);
  EXPECT_EQ(decoded(), Verdict::malformed);
  message.set_rotation_energy_joule(0);
  message.set_orientation_handle_in_master_wxyz(0, 1 + 2e-6);
  EXPECT_EQ(decoded(), Verdict::malformed);
}

TEST_F(Foreign, AnUnknownModeIsMalformed) {
  message.clear_mode();
  message.mutable_unknown_fields()->AddVarint(6, kModes);
  EXPECT_EQ(decoded(), Verdict::malformed);
}

TEST_F(Foreign, AWaveOfAnotherLengthIsMalformed) {
  message.mutable_wave()->mutable_integral()->Truncate(2);
  EXPECT_EQ(decoded(), Verdict::malformed);
  message.mutable_wave()->mutable_integral()->Add(0);
  EXPECT_EQ(decoded(), Verdict::accepted);
  message.mutable_wave()->clear_energy_joule();
  EXPECT_EQ(decoded(), Verdict::malformed);
}

TEST_F(Foreign, AppendedFieldsAreMalformed) {
  message.mutable_unknown_fields()->AddVarint(99, 1);
  EXPECT_EQ(decoded(), Verdict::malformed);
}

TEST(CodecHello, ComesBackAndHasOneSize) {
  Codec codec;
  Payload payload;
  const Hello sent{.role = Role::slave,
                   .session = 7,
                   .scene_hash = 8,
                   .peer_session = 10,
                   .lease = Lease::refused,
                   .leases = 11};
  Hello got;
  ASSERT_EQ(codec.encode(sent, payload), kHelloBytes);
  ASSERT_EQ(codec.decode(std::span(payload).first(kHelloBytes), got), Verdict::accepted);
  EXPECT_EQ(got.role, Role::slave);
  EXPECT_EQ(got.session, 7u);
  EXPECT_EQ(got.scene_hash, 8u);
  EXPECT_EQ(got.peer_session, 10u);
  EXPECT_EQ(got.lease, Lease::refused);
  EXPECT_EQ(got.leases, 11u);
  ASSERT_EQ(codec.encode(Hello{.session = 7, .take_over = true}, payload), kHelloBytes);
  ASSERT_EQ(codec.decode(std::span(payload).first(kHelloBytes), got), Verdict::accepted);
  EXPECT_TRUE(got.take_over);
  EXPECT_EQ(got.role, Role::master);
}

TEST(CodecHello, WhatOnlyTheOtherSideMaySayIsRefused) {
  Codec codec;
  Payload payload;
  EXPECT_EQ(codec.encode(Hello{.session = 0}, payload), 0u);
  EXPECT_EQ(codec.encode(Hello{.session = 7, .lease = Lease::held}, payload), 0u);
  EXPECT_EQ(codec.encode(Hello{.session = 7, .leases = 1}, payload), 0u);
  EXPECT_EQ(codec.encode(Hello{.role = Role::slave, .session = 7, .take_over = true}, payload), 0u);
  EXPECT_EQ(codec.encode(Hello{.role = Role::slave, .session = 7, .lease = Lease(4)}, payload), 0u);
}

TEST(CodecHello, AnotherVersionIsRecognisedWhateverFollowsIt) {
  Codec codec;
  std::string bytes(1, static_cast<char>(PayloadType::hello));
  proto::Hello future;
  future.set_protocol_version(kProtocolVersion + 1);
  future.mutable_unknown_fields()->AddLengthDelimited(77, "whatever they will think of");
  future.AppendPartialToString(&bytes);
  Hello got;
  EXPECT_EQ(codec.decode(std::as_bytes(std::span(bytes)), got), Verdict::wrong_version);
  EXPECT_EQ(got.protocol_version, kProtocolVersion + 1);
}

TEST(CodecHello, AnIncompleteOneIsMalformed) {
  Codec codec;
  Payload payload;
  Hello got;
  codec.encode(Hello{.session = 7}, payload);
  for (std::size_t n = 1; n < kHelloBytes; ++n)
    EXPECT_EQ(codec.decode(std::span(payload).first(n), got), Verdict::malformed) << n;
  EXPECT_EQ(codec.decode(std::span(payload).first(kHelloBytes + 1), got), Verdict::malformed);
}

}  // namespace
}  // namespace farhand
