#include "master/falcon_usb/exchange.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/falcon_usb/emulated_falcon.hpp"

namespace farhand::falcon_usb {
namespace {

std::vector<std::byte> answer(int number, int times = 1) {
  const Packet packet = encode(Answer{.encoders = {static_cast<std::int16_t>(number), 0, 0}});
  std::vector<std::byte> out;
  for (int i = 0; i < times; ++i) out.insert(out.end(), packet.begin(), packet.end());
  return out;
}

std::vector<std::byte> together(std::vector<std::byte> a, const std::vector<std::byte>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// One after the questions at the start, which are asked slowly.
struct Trusted {
  Exchange exchange;
  TimePoint now = kStart;

  Trusted() {
    for (int i = 0; i < 3; ++i) {
      now += 3ms;
      exchange.asked(now);
      exchange.hear(answer(0), now + 1ms);
    }
    now += 1ms;
  }
  int heard(const std::vector<std::byte>& bytes) {
    const Sample* sample = exchange.hear(bytes, now);
    return sample == nullptr ? -1 : sample->answer.encoders[0];
  }
};

TEST(Exchange, TheNextQuestionIsFreeAtOnceAfterAnAnswer) {
  Trusted t;
  EXPECT_TRUE(t.exchange.free(t.now));
  t.exchange.asked(t.now);
  EXPECT_FALSE(t.exchange.free(t.now + 1999us));
  t.now += 900us;
  EXPECT_EQ(t.heard(answer(7)), 7);
  EXPECT_TRUE(t.exchange.free(t.now));
}

// The question before may be the one: an answer that came twice cannot be told from the next.
TEST(Exchange, ASampleSaysHowOldItMayBe) {
  Trusted t;
  t.exchange.asked(t.now);
  t.now += 1ms;
  t.exchange.hear(answer(0), t.now);
  t.exchange.asked(t.now);
  t.now += 900us;
  EXPECT_EQ(t.exchange.hear(answer(1), t.now)->age, Duration(1900us));
  t.exchange.asked(t.now);
  t.now += 2ms;
  t.exchange.asked(t.now);
  t.now += 900us;
  EXPECT_EQ(t.exchange.hear(answer(2), t.now)->age, Duration(3800us));
}

TEST(Exchange, AnswersInPiecesAreOne) {
  Trusted t;
  t.exchange.asked(t.now);
  const auto bytes = answer(5);
  EXPECT_EQ(t.heard({bytes.begin(), bytes.begin() + 14}), -1);
  EXPECT_EQ(t.heard({bytes.begin() + 14, bytes.end()}), 5);
}

TEST(Exchange, WhatNobodyAskedForIsNotTaken) {
  Trusted t;
  EXPECT_EQ(t.heard(answer(5)), -1);
  EXPECT_EQ(t.exchange.counters().surplus, 1u);
}

TEST(Exchange, AnAnswerTwiceCountsOnce) {
  Trusted t;
  t.exchange.asked(t.now);
  EXPECT_EQ(t.heard(answer(5, 2)), 5);
  EXPECT_EQ(t.exchange.counters().surplus, 1u);
  EXPECT_FALSE(t.exchange.free(t.now));  // another may follow
}

TEST(Exchange, ALateAnswerAndItsFollowerCostNothing) {
  Trusted t;
  t.exchange.asked(t.now);
  t.now += 2ms;
  EXPECT_TRUE(t.exchange.free(t.now));
  t.exchange.asked(t.now);
  t.now += 400us;
  EXPECT_EQ(t.heard(together(answer(5), answer(6))), 6);
  EXPECT_EQ(t.exchange.counters().unanswered, 1u);
  EXPECT_EQ(t.exchange.counters().surplus, 0u);
}

// The first of two questions was answered late and the second later still, when a third was out.
TEST(Exchange, AnAnswerBehindItsQuestionIsCaughtWithinTwoQuestions) {
  Trusted t;
  int answered = 0;
  TimePoint asked[8];
  auto ask = [&, k = 0]() mutable {
    while (!t.exchange.free(t.now)) t.now += 100us;
    t.exchange.asked(asked[k++] = t.now);
  };
  ask(), ask();
  t.now += 1ms;
  EXPECT_EQ(t.heard(answer(answered++)), 0);
  ask();  // the second one's answer has not come: it is thought lost
  t.now += 500us;
  const Sample* late = t.exchange.hear(answer(answered++), t.now);
  ASSERT_NE(late, nullptr);
  EXPECT_GE(late->age, t.now - asked[1]);  // the truth is within what the sample says
  t.now += 500us;
  EXPECT_EQ(t.heard(answer(answered++)), -1);  // the third one's
  EXPECT_EQ(t.exchange.counters().surplus, 1u);
  ask();
  t.now += 1ms;
  EXPECT_EQ(t.heard(answer(answered++)), 3);
}

}  // namespace
}  // namespace farhand::falcon_usb
