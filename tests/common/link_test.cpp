#include "common/link.hpp"

#include <algorithm>

#include "tests/support/allocations.hpp"
#include "tests/support/link_ends.hpp"
#include "tests/support/messages.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

TEST_F(LinkTest, ShakesHandsAndCarriesMessagesBothWays) {
  EXPECT_FALSE(master.connected() || slave.connected());
  EXPECT_TRUE(master.encode({}, now).empty());  // to nobody yet
  connect();
  EXPECT_EQ(slave.peer()->session, 1u);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    now += 1ms;
    MasterToSlave down;
    SlaveToMaster up;
    randomise(random, down);
    randomise(random, up);
    ASSERT_EQ(slave.receive(master.encode(down, now), now), Verdict::accepted);
    ASSERT_EQ(master.receive(slave.encode(up, now), now), Verdict::accepted);
    ASSERT_TRUE(same(slave.newest()->message, down) && same(master.newest()->message, up));
    ASSERT_EQ(slave.newest()->received, now);
  }
  EXPECT_EQ(slave.counters().dropped(), 0u);
  EXPECT_EQ(slave.quality().lost, 0u);
}

TEST_F(LinkTest, SaysHelloOnceAPeriodUntilAnsweredAndAgainInSilence) {
  EXPECT_FALSE(master.hello_due(now).empty());
  EXPECT_TRUE(master.hello_due(now).empty());
  EXPECT_TRUE(master.hello_due(now + 99ms).empty());
  EXPECT_FALSE(master.hello_due(now + 100ms).empty());
  now += 200ms;
  connect();
  EXPECT_TRUE(master.hello_due(now + 500ms).empty());
  EXPECT_FALSE(master.hello_due(now + 501ms).empty());
  EXPECT_TRUE(master.connected());  // silence alone does not end it
}

TEST_F(LinkTest, AHelloFromANewPeerIsAnsweredAtOnce) {
  EXPECT_FALSE(master.hello_due(now).empty());
  now += 10ms;
  master.receive(slave.hello_due(now), now);
  EXPECT_FALSE(master.hello_due(now).empty());
}

TEST_F(LinkTest, EveryReasonToDropHasItsCounter) {
  connect();
  const Bytes good = next(), older = next();
  ASSERT_EQ(slave.receive(good, now), Verdict::accepted);
  const auto changed = [&](std::size_t at, auto f) {
    Bytes bad = next();
    bad[at] ^= std::byte{1};
    f(bad);
    return bad;
  };
  const auto nothing = [](Bytes&) {};
  expect_dropped({}, Verdict::too_short);
  expect_dropped(Bytes(kMaxDatagramBytes + 1), Verdict::too_long);
  expect_dropped(changed(0, nothing), Verdict::bad_magic);
  expect_dropped(changed(8, [](Bytes& b) { b.pop_back(); }), Verdict::bad_length);
  expect_dropped(changed(100, nothing), Verdict::bad_checksum);
  Bytes strange(kMaxDatagramBytes);
  strange.resize(seal(Bytes(20, std::byte{9}), strange));
  expect_dropped(strange, Verdict::unexpected_type);
  expect_dropped(copy(slave.encode({}, now)), Verdict::wrong_role);
  expect_dropped(hello({.role = Role::slave, .session = 5, .scene_hash = kScene}),
                 Verdict::wrong_role);
  Bytes cut(kMaxDatagramBytes);
  cut.resize(seal(Bytes(20, std::byte{2}), cut));
  expect_dropped(cut, Verdict::malformed);
  expect_dropped(hello({.protocol_version = 99, .session = 5, .scene_hash = kScene}),
                 Verdict::wrong_version);
  expect_dropped(hello({.session = 5, .scene_hash = kScene + 1}), Verdict::wrong_scene);
  expect_dropped(hello({.session = 5, .scene_hash = kScene}), Verdict::leased);
  expect_dropped(forged([](Header& h) { h.session = 77; }), Verdict::foreign_session);
  expect_dropped(forged([](Header& h) { h.peer_session = 77; }), Verdict::other_recipient);
  expect_dropped(forged([](Header& h) { h.echo_sequence = 77; }), Verdict::bad_echo);
  expect_dropped(forged([&](Header& h) {
                   h.echo_sent = static_cast<std::uint64_t>((now.time_since_epoch() + 1ns).count());
                 }),
                 Verdict::bad_echo);
  expect_dropped(good, Verdict::duplicate);
  ASSERT_EQ(slave.receive(next(), now), Verdict::accepted);
  expect_dropped(older, Verdict::older);
  now += 101ms;  // the echo of our first message, with the fastest way of 0
  expect_dropped(forged([&](Header& h) {
                   h.sent = h.echo_sent =
                       static_cast<std::uint64_t>(kStart.time_since_epoch().count());
                   h.echo_sequence = 1;
                 }),
                 Verdict::too_late);
  const auto secure = [](Verdict v) {  // of the secure channel, which a plain link never gives
    return v >= Verdict::wrong_content && v <= Verdict::not_authentic;
  };
  for (std::size_t i = 0; i < kVerdicts; ++i) {
    const auto v = static_cast<Verdict>(i);
    EXPECT_EQ(slave.counters()[v] > 0, !secure(v)) << to_string(v);
  }
}

TEST_F(LinkTest, DataBeforeTheHelloIsForeign) {
  master.receive(slave.hello_due(now), now);
  expect_dropped(next(), Verdict::foreign_session);
  EXPECT_FALSE(slave.connected());
}

TEST_F(LinkTest, NewestWinsAndTheRestIsAccountedFor) {
  connect();
  std::vector<Bytes> sent;
  for (std::uint32_t i = 0; i < 10; ++i) sent.push_back(next(i));
  const auto deliver = [&](std::size_t i) { return slave.receive(sent[i], now); };
  EXPECT_EQ(deliver(0), Verdict::accepted);
  EXPECT_EQ(deliver(4), Verdict::accepted);
  EXPECT_EQ(slave.quality().lost, 3u);
  EXPECT_EQ(deliver(2), Verdict::older);
  EXPECT_EQ(slave.newest()->message.clutch_presses, 4u);
  EXPECT_EQ(slave.quality().lost, 2u);
  EXPECT_EQ(slave.quality().reordered, 1u);
  EXPECT_EQ(deliver(2), Verdict::duplicate);
  EXPECT_EQ(deliver(4), Verdict::duplicate);
  EXPECT_EQ(deliver(9), Verdict::accepted);
  EXPECT_EQ(slave.quality().lost, 6u);
  EXPECT_EQ(slave.quality().reordered, 1u);
  EXPECT_EQ(slave.newest()->message.clutch_presses, 9u);
}

TEST_F(LinkTest, FreshIsAMatterOfArrival) {
  EXPECT_FALSE(slave.fresh(now, 1h));
  connect();
  EXPECT_TRUE(slave.fresh(now + 20ms, 20ms));
  EXPECT_FALSE(slave.fresh(now + 20ms + 1ns, 20ms));
}

// A pair with both clocks known, over a way of 5 ms each.
class LatenessTest : public LinkTest {
 protected:
  static constexpr Duration kWay = 5ms;
  LatenessTest() {
    slave.receive(copy(master.hello_due(now)), now);
    master.receive(copy(slave.hello_due(now)), now);
    for (int i = 0; i < 100; ++i) exchange(kWay, kWay);
    EXPECT_TRUE(slave.clock().valid && master.clock().valid);
  }
  // A message there and one back, so long on their ways; the clocks of both sides are one.
  std::pair<Verdict, Verdict> exchange(Duration there, Duration back) {
    const Bytes down = next(), up = copy(slave.encode({}, now));
    const auto verdicts =
        std::pair(slave.receive(down, now + there), master.receive(up, now + back));
    now += std::max(there, back) + 20ms;
    return verdicts;
  }
};

// Seconds of messages wait in a queue while the slave is stopped, longer than the clock remembers.
TEST_F(LatenessTest, WhatWaitedWhileASideSleptIsNotTaken) {
  for (const Duration sleep : {Duration(2s), Duration(15s)}) {
    std::vector<Bytes> queue;
    for (const TimePoint end = now + sleep; now < end; now += 1ms) queue.push_back(next());
    const std::uint64_t before = slave.newest()->sequence, lost = slave.quality().lost;
    std::uint64_t too_late = 0;
    for (const Bytes& datagram : queue) {
      const Duration waited = std::chrono::milliseconds(&queue.back() - &datagram + 1);
      const Verdict verdict = slave.receive(datagram, now + kWay);
      ASSERT_EQ(verdict, waited > 100ms ? Verdict::too_late : Verdict::accepted) << waited.count();
      too_late += verdict == Verdict::too_late;
      if (verdict == Verdict::too_late) {
        ASSERT_EQ(slave.newest()->sequence, before);
      }
    }
    EXPECT_EQ(slave.quality().lost, lost + too_late);
    EXPECT_EQ(slave.clock().round_trip, 2 * kWay);
    for (int i = 0; i < 10; ++i) {
      now += 20ms;
      slave.receive(next(), now + kWay);
      master.receive(copy(slave.encode({}, now)), now + kWay);
    }
  }
}

TEST_F(LatenessTest, TheLimitIsAboveTheFastest) {
  EXPECT_EQ(exchange(kWay, kWay + 100ms).second, Verdict::accepted);
  EXPECT_EQ(exchange(kWay, kWay + 100ms + 1ns).second, Verdict::too_late);
  EXPECT_EQ(exchange(kWay + 100ms + 1ns, kWay).first, Verdict::too_late);
  EXPECT_EQ(exchange(kWay + 90ms, kWay + 90ms), std::pair(Verdict::accepted, Verdict::accepted));
}

// Both ways at once, so that neither side has anything new to echo.
TEST_F(LatenessTest, ANetworkThatGotSlowerForGoodIsAcceptedAfterTheClocksWindow) {
  const TimePoint begin = now;
  std::optional<TimePoint> first;
  while (now < begin + 20s) {
    const TimePoint sent = now;
    const auto [there, back] = exchange(kWay + 200ms, kWay + 200ms);
    if (!first && there == Verdict::accepted) first = sent;
    ASSERT_EQ(first.has_value(), there == Verdict::accepted) << seconds(now - begin);
    ASSERT_EQ(first.has_value(), back == Verdict::accepted) << seconds(now - begin);
  }
  ASSERT_TRUE(first);
  EXPECT_GE(*first - begin, Duration(ClockSync::kWindow));
  EXPECT_LT(*first - begin, ClockSync::kWindow + kWay + 200ms + 20ms);
  EXPECT_EQ(slave.clock().round_trip, 2 * (kWay + 200ms));
}

// The stamps alone say that all is late, the round trip that nothing is.
TEST_F(LatenessTest, AStepOfTheOtherClockIsNoLateness) {
  for (const Duration step : {-3s, 3s}) {
    master.receive(copy(slave.encode({}, now)), now + kWay);
    for (int i = 0; i < 100; ++i, now += 20ms) {  // the master's clock is so much ahead
      if (i == 0) continue;
      const Bytes down = copy(master.encode({}, now + 10s + step));
      ASSERT_EQ(slave.receive(down, now + kWay), Verdict::accepted) << i;
      ASSERT_EQ(master.receive(copy(slave.encode({}, now + kWay)), now + 10s + step + 2 * kWay),
                Verdict::accepted);
    }
  }
}

TEST_F(LinkTest, WhatThePeerWouldRefuseIsNotSent) {
  connect();
  MasterToSlave broken;
  broken.p_MH.x() = NAN;
  EXPECT_TRUE(master.encode(broken, now).empty());
  EXPECT_EQ(master.counters().refused_to_send, 1u);
  EXPECT_EQ(slave.receive(next(), now), Verdict::accepted);
  EXPECT_EQ(slave.quality().lost, 0u);  // and takes no number
}

TEST_F(LinkTest, TheRefusedPeerSaysWhyUntilItMends) {
  EXPECT_EQ(slave.peer_refusal().reason, PeerRefusal::Reason::none);
  slave.receive(hello({.protocol_version = 9, .session = 5, .scene_hash = kScene}), now);
  EXPECT_EQ(slave.peer_refusal().reason, PeerRefusal::Reason::version);
  EXPECT_EQ(slave.peer_refusal().peer_version, 9u);
  slave.receive(hello({.session = 5, .scene_hash = 17}), now);
  EXPECT_EQ(slave.peer_refusal().reason, PeerRefusal::Reason::scene);
  EXPECT_EQ(slave.peer_refusal().peer_scene_hash, 17u);
  EXPECT_FALSE(slave.peer().has_value());
  slave.receive(hello({.session = 5, .scene_hash = kScene}), now);
  EXPECT_EQ(slave.peer_refusal().reason, PeerRefusal::Reason::none);
  EXPECT_EQ(slave.peer()->session, 5u);
}

TEST_F(LinkTest, ARestartedPeerTakesThePlaceOfTheOldOneForGood) {
  connect();
  const Bytes old_hello = hello({.session = 1, .scene_hash = kScene}), old_data = next();
  MasterLink again({.session = 11, .scene_hash = kScene});
  now += 501ms;
  ASSERT_EQ(slave.receive(again.hello_due(now), now), Verdict::accepted);
  EXPECT_FALSE(slave.connected());
  EXPECT_EQ(slave.newest(), nullptr);
  EXPECT_FALSE(slave.clock().valid);
  expect_dropped(old_data, Verdict::foreign_session);
  expect_dropped(old_hello, Verdict::foreign_session);  // from the network's memory
  ASSERT_EQ(again.receive(slave.hello_due(now), now), Verdict::accepted);
  ASSERT_EQ(slave.receive(again.encode(numbered(5), now), now), Verdict::accepted);
  EXPECT_EQ(slave.newest()->message.clutch_presses, 5u);
}

TEST_F(LinkTest, StampsGiveTheRoundTripTheAgeAndTheOffset) {
  constexpr Duration kOffset = 5s, kWay = 8ms, kHold = 300us;  // the slave's clock is ahead
  slave.receive(copy(master.hello_due(now)), now + kOffset);
  master.receive(copy(slave.hello_due(now + kOffset)), now);
  for (int i = 0; i < 20; ++i, now += 20ms) {
    slave.receive(copy(master.encode({}, now)), now + kWay + kOffset);
    const Bytes answer = copy(slave.encode({}, now + kWay + kHold + kOffset));
    master.receive(answer, now + 2 * kWay + kHold);
  }
  now += 2 * kWay + kHold - 20ms;
  EXPECT_EQ(master.quality().round_trip, 2 * kWay);
  EXPECT_EQ(master.quality().jitter, 0s);
  EXPECT_EQ(master.clock().offset, kOffset);
  EXPECT_EQ(master.clock().uncertainty, kWay + 38us);  // 100 ppm of 19 exchanges' 20 ms
  EXPECT_TRUE(master.newest()->transit_known);
  EXPECT_EQ(master.newest()->age(now), kWay);
  EXPECT_EQ(master.newest()->age(now + 3ms), kWay + 3ms);
  EXPECT_EQ(slave.clock().offset, -kOffset);
  EXPECT_EQ(slave.newest()->transit, kWay);
}

TEST_F(LinkTest, JitterConvergesOnTheMeanChangeOfTransit) {
  connect();
  for (int i = 0; i < 500; ++i) {  // 1 ms and 4 ms in turns: every change is 3 ms
    now += 20ms;
    slave.receive(next(), now + (i % 2 == 0 ? 1ms : 4ms));
  }
  EXPECT_NEAR(seconds(slave.quality().jitter), 3e-3, 1e-6);
}

TEST_F(LinkTest, TakesNothingFromTheHeapOnceBuilt) {
  Random random(2);
  Bytes junk(300);
  EXPECT_EQ(allocations_in([&] {
              for (int i = 0; i < 2000; ++i, now += 1ms) {
                slave.receive(master.hello_due(now), now);
                master.receive(slave.hello_due(now), now);
                MasterToSlave down;
                randomise(random, down);
                slave.receive(master.encode(down, now), now);
                master.receive(slave.encode({}, now), now);
                junk[static_cast<std::size_t>(i) % junk.size()] = std::byte{1};
                slave.receive(junk, now);
              }
            }),
            0u);
  EXPECT_TRUE(master.connected() && slave.connected());
}

}  // namespace
}  // namespace farhand
