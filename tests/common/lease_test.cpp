// Which of several masters leads a slave (common/link.hpp).
#include "tests/support/link_ends.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

// Several masters and the slave, each heard by the slave at once and told at once. A tick is 1 ms.
class LeaseTest : public LinkTest {
 protected:
  static LinkConfig config(std::uint64_t session, bool take_over = false) {
    return {.session = session, .scene_hash = kScene, .take_over = take_over};
  }
  void turn(MasterLink& m) {
    for (const Bytes& datagram : {copy(m.hello_due(now)), copy(m.encode(numbered(7), now))}) {
      if (datagram.empty()) continue;
      const Verdict verdict = slave.receive(datagram, now);
      if (verdict == Verdict::accepted) leader = &m;
      ASSERT_LE(slave.answer().size(), datagram.size());
      if (!slave.answer().empty()) m.receive(copy(slave.answer()), now);
    }
  }
  void run(Duration length, std::initializer_list<MasterLink*> masters) {
    for (const TimePoint end = now + length; now < end; now += 1ms) {
      for (MasterLink* m : masters) turn(*m);
      if (leader == nullptr) continue;
      for (const Bytes& datagram : {copy(slave.hello_due(now)), copy(slave.encode({}, now))})
        if (!datagram.empty()) leader->receive(datagram, now);
    }
  }
  bool leads(const MasterLink& m) const {
    return leader == &m && m.fresh(now, 2ms) && slave.fresh(now, 2ms);
  }
  static PeerRefusal::Reason refusal(const MasterLink& m) { return m.peer_refusal().reason; }

  MasterLink* leader = nullptr;  // where the slave's datagrams go
  MasterLink second{config(11)};
};

using Refusal = PeerRefusal::Reason;

TEST_F(LeaseTest, ASecondMasterIsRefusedAndToldAndTheFirstDoesNotNotice) {
  run(100ms, {&master});
  ASSERT_TRUE(leads(master));
  run(5s, {&master, &second});
  EXPECT_TRUE(leads(master));
  EXPECT_EQ(slave.counters()[Verdict::leased], 50u);  // one hello each 100 ms
  EXPECT_EQ(second.counters()[Verdict::leased], 50u);
  EXPECT_EQ(refusal(second), Refusal::led);
  EXPECT_EQ(refusal(master), Refusal::none);
  EXPECT_TRUE(second.encode({}, now).empty());
  EXPECT_EQ(slave.quality().lost, 0u);
}

TEST_F(LeaseTest, ARestartedMasterGetsInByItselfWhenTheLeaseIsOver) {
  run(100ms, {&master});
  const TimePoint last = slave.newest()->received;
  while (!leads(second)) {
    run(1ms, {&second});
    ASSERT_EQ(refusal(second), Refusal::none);  // no longer than a crashed one's lease
    ASSERT_LE(now, last + 1s);
  }
  EXPECT_GT(now - 1ms, last + 500ms);
  EXPECT_LE(now - 1ms, last + 500ms + 100ms);  // and a hello's period
  run(1s, {&second});
  EXPECT_TRUE(leads(second));
}

TEST_F(LeaseTest, WhoWaitsGetsInWhenTheLeaderIsGone) {
  run(3s, {&master, &second});
  ASSERT_EQ(refusal(second), Refusal::led);
  run(700ms, {&second});
  EXPECT_TRUE(leads(second));
  EXPECT_EQ(refusal(second), Refusal::none);
}

TEST_F(LeaseTest, ASilentLeaderComesBackIfNobodyCameMeanwhile) {
  run(100ms, {&master});
  run(10s, {});
  run(10ms, {&master});
  EXPECT_TRUE(leads(master));
}

TEST_F(LeaseTest, OneThatComesBackTooLateIsTold) {
  run(100ms, {&master});
  run(700ms, {&second});
  ASSERT_TRUE(leads(second));
  run(100ms, {&master, &second});
  EXPECT_TRUE(leads(second));
  EXPECT_TRUE(master.taken_over());
}

TEST_F(LeaseTest, ATakeOverIsAtOnceAndTheFormerMasterIsToldAndGivesIn) {
  run(100ms, {&master});
  MasterLink taker(config(12, true));
  const Bytes its_hello = copy(taker.hello_due(now));
  const Bytes before = copy(master.encode({}, now)),
              hello_before = copy(master.hello_due(now + 1h));
  ASSERT_EQ(slave.receive(its_hello, now), Verdict::accepted);
  leader = &taker;
  EXPECT_EQ(slave.newest(), nullptr);  // so the robot is held
  run(3ms, {&master, &taker});
  EXPECT_TRUE(leads(taker));
  EXPECT_TRUE(master.taken_over());
  EXPECT_FALSE(taker.taken_over());
  run(5s, {&master, &taker});
  EXPECT_TRUE(leads(taker));
  EXPECT_TRUE(master.hello_due(now).empty() && master.encode({}, now).empty());
  // What the network kept of the former one changes nothing, nor does the taker's own.
  expect_dropped(before, Verdict::foreign_session);
  expect_dropped(hello_before, Verdict::foreign_session);
  EXPECT_EQ(slave.receive(its_hello, now), Verdict::accepted);
  EXPECT_TRUE(leads(taker));
}

TEST_F(LeaseTest, OfTwoThatTakeOverTheLastOneLeadsAndNobodyFights) {
  MasterLink one(config(12, true)), two(config(13, true));
  run(100ms, {&master});
  const Bytes hello_of_one = copy(one.hello_due(now));
  slave.receive(hello_of_one, now);
  leader = &one;
  run(100ms, {&master, &one});
  ASSERT_TRUE(leads(one));
  run(3ms, {&one, &two});
  EXPECT_TRUE(leads(two));
  EXPECT_TRUE(one.taken_over() && master.taken_over());
  expect_dropped(hello_of_one, Verdict::foreign_session);  // a replay takes nothing over
  run(5s, {&master, &one, &two});
  EXPECT_TRUE(leads(two));
  EXPECT_FALSE(two.taken_over());
}

TEST_F(LeaseTest, ATakerBeatenBeforeItHeardAnythingGivesInToo) {
  MasterLink one(config(12, true)), two(config(13, true));
  slave.receive(copy(one.hello_due(now)), now);
  slave.receive(copy(two.hello_due(now)), now);
  leader = &two;
  run(1s, {&one, &two});
  EXPECT_TRUE(leads(two));
  EXPECT_TRUE(one.taken_over());
}

// The taker that led once is as any other: after the slave's restart it takes over no more.
TEST_F(LeaseTest, ATakeOverIsForOneTime) {
  MasterLink taker(config(12, true));
  run(100ms, {&taker});
  ASSERT_TRUE(leads(taker));
  SlaveLink restarted({.session = 22, .scene_hash = kScene});
  now += 1s;
  ASSERT_EQ(restarted.receive(copy(second.hello_due(now)), now), Verdict::accepted);
  ASSERT_EQ(restarted.receive(copy(taker.hello_due(now)), now), Verdict::leased);
  taker.receive(copy(restarted.answer()), now);
  EXPECT_TRUE(taker.encode({}, now).empty());
  EXPECT_FALSE(taker.taken_over());
  now += 501ms;
  ASSERT_EQ(restarted.receive(copy(taker.hello_due(now)), now), Verdict::accepted);
  EXPECT_EQ(taker.receive(copy(restarted.hello_due(now)), now), Verdict::accepted);
  EXPECT_EQ(restarted.receive(copy(taker.encode({}, now)), now), Verdict::accepted);
}

// What waited is too late to move anything, but shows that the leader lives.
TEST_F(LeaseTest, ASlaveThatSleptKeepsItsMaster) {
  run(100ms, {&master, &second});
  std::vector<Bytes> queue;
  for (const TimePoint end = now + 2s; now < end; now += 1ms)
    for (MasterLink* m : {&master, &second})
      for (const Bytes& datagram : {copy(m->encode({}, now)), copy(m->hello_due(now))})
        if (!datagram.empty()) queue.push_back(datagram);
  for (const Bytes& datagram : queue) slave.receive(datagram, now);
  EXPECT_GT(slave.counters()[Verdict::too_late], 1800u);
  EXPECT_EQ(slave.counters()[Verdict::leased], 21u);
  run(10ms, {&master, &second});
  EXPECT_TRUE(leads(master));
}

TEST_F(LeaseTest, ARefusalThatComesAfterTheLeaseIsOfThePast) {
  run(100ms, {&master});
  slave.receive(copy(second.hello_due(now)), now);
  const Bytes refusal = copy(slave.answer());
  run(700ms, {&second});
  ASSERT_TRUE(leads(second));
  EXPECT_EQ(second.receive(refusal, now), Verdict::older);
  EXPECT_TRUE(leads(second));
}

TEST_F(LeaseTest, AnAnswerToAnotherMasterIsNotHeard) {
  run(100ms, {&master});
  slave.receive(copy(second.hello_due(now)), now);
  EXPECT_EQ(master.receive(copy(slave.answer()), now), Verdict::other_recipient);
  EXPECT_EQ(second.receive(copy(slave.hello_due(now + 1h)), now), Verdict::other_recipient);
}

}  // namespace
}  // namespace farhand
