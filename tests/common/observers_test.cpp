// Who looks sees the newest status, and nothing but that comes of looking.
#include "common/observers.hpp"

#include <gtest/gtest.h>

#include <string>

#include "common/channel.hpp"
#include "common/secure_channel.hpp"
#include "tests/support/both_proofs.hpp"
#include "tests/support/dtls_ends.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

std::string text(std::span<const std::byte> payload) {
  std::string out;
  for (const std::byte b : payload.subspan(1)) out += static_cast<char>(b);
  return out;
}

// Sends at once, to whom it says.
struct Served {
  explicit Served(const std::optional<Credentials>& credentials)
      : observers(credentials, [this](std::span<const std::byte> d, const UdpAddress& to) {
          sent.emplace_back(copy(d), to);
        }) {}

  std::vector<std::pair<Bytes, UdpAddress>> sent;
  Observers observers;
};

Bytes plain(std::span<const std::byte> payload) {
  Bytes out(kMaxDatagramBytes);
  out.resize(seal(payload, out));
  return out;
}

constexpr TimePoint kNow{std::chrono::hours(1)};

TEST(Observers, AQuestionIsAnsweredWithTheNewestStatus) {
  Served s({});
  const Bytes asked = plain(question());
  s.observers.receive(asked, kClientAddress, kNow);
  EXPECT_TRUE(s.sent.empty());  // nothing to show yet
  s.observers.show("first");
  s.observers.show("second");
  s.observers.receive(asked, kClientAddress, kNow);
  ASSERT_EQ(s.sent.size(), 1u);
  EXPECT_EQ(s.sent[0].second, kClientAddress);
  Bytes payload(kMaxPayloadBytes);
  const Opened opened = open(s.sent[0].first, payload);
  ASSERT_EQ(opened.verdict, Verdict::accepted);
  EXPECT_EQ(payload[0], kAnswer);
  EXPECT_EQ(text(std::span(payload).first(opened.size)), "second");
}

TEST(Observers, NoAnswerIsLongerThanItsQuestion) {
  Served s({});
  s.observers.show(std::string(kQuestionBytes - 1, 'x'));
  const Bytes asked = plain(question());
  s.observers.receive(asked, kClientAddress, kNow);
  ASSERT_EQ(s.sent.size(), 1u);
  EXPECT_EQ(s.sent[0].first.size(), asked.size());
  EXPECT_THROW(s.observers.show(std::string(kQuestionBytes, 'x')), std::length_error);
}

TEST(Observers, WhatIsNoQuestionIsNotAnswered) {
  Served s({});
  s.observers.show("status");
  const auto asked = question();
  auto other = asked;
  other[0] = kAnswer;
  for (const Bytes& datagram :
       {Bytes{}, Bytes(300), plain(std::span(asked).first(kQuestionBytes - 1)), plain(other),
        plain(Bytes(kQuestionBytes, std::byte{1}))})
    s.observers.receive(datagram, kClientAddress, kNow);
  EXPECT_TRUE(s.sent.empty());
}

// Somebody who looks through DTLS.
struct Looker {
  Looker(std::uint8_t last, const Credentials& credentials)
      : address(test_address(last)), channel({.server = kServerAddress}, credentials) {}

  void turn(Served& s, TimePoint now) {
    channel.service(now);
    while (const DtlsOutgoing* out = channel.outgoing())
      s.observers.receive(out->datagram(), address, now);
    Bytes record(kMaxDatagramBytes);
    record.resize(channel.seal(question(), record));
    if (!record.empty()) s.observers.receive(record, address, now);
    s.observers.tick(now);
  }
  void receive(std::span<const std::byte> datagram) {
    Bytes payload(kMaxPayloadBytes);
    if (channel.take(datagram, kServerAddress)) return;
    const Opened opened = channel.open(datagram, payload);
    if (opened.verdict == Verdict::accepted)
      seen.push_back(text(std::span(payload).first(opened.size)));
  }

  UdpAddress address;
  SecureChannel channel;
  std::vector<std::string> seen;
};

void run(Served& s, std::vector<std::unique_ptr<Looker>>& lookers, TimePoint& now, int turns) {
  for (int i = 0; i < turns; ++i, now += milliseconds(5)) {
    for (auto& l : lookers) l->turn(s, now);
    for (const auto& [datagram, to] : std::exchange(s.sent, {}))
      for (auto& l : lookers)
        if (l->address == to) l->receive(datagram);
  }
}

class SecureObservers : public testing::TestWithParam<Proof> {
 protected:
  const SideCredentials ours = test_credentials(GetParam(), 1);
  const SideCredentials others = test_credentials(GetParam(), 2);
};

TEST_P(SecureObservers, SeveralWithTheKeyLookAtOnceAndNobodyWithout) {
  Served s(ours.server);
  s.observers.show("status");
  std::vector<std::unique_ptr<Looker>> lookers;
  for (std::uint8_t i = 0; i < 3; ++i)
    lookers.push_back(std::make_unique<Looker>(10 + i, ours.client));
  TimePoint now = kNow;
  run(s, lookers, now, 2000);
  for (const auto& l : lookers) {
    ASSERT_GT(l->seen.size(), 1000u);
    EXPECT_EQ(l->seen.back(), "status");
  }
  s.observers.receive(plain(question()), test_address(10), now);
  EXPECT_TRUE(s.sent.empty());
  lookers.clear();
  lookers.push_back(std::make_unique<Looker>(20, others.client));
  run(s, lookers, now, 2000);
  EXPECT_TRUE(lookers[0]->seen.empty());
}

TEST_P(SecureObservers, TheOneSilentForLongestMakesRoom) {
  Served s(ours.server);
  s.observers.show("status");
  TimePoint now = kNow;
  std::vector<std::unique_ptr<Looker>> lookers;
  for (std::uint8_t i = 0; i <= Observers::kMost; ++i) {
    std::vector<std::unique_ptr<Looker>> alone;
    alone.push_back(std::make_unique<Looker>(10 + i, ours.client));
    run(s, alone, now, 300);
    ASSERT_FALSE(alone[0]->seen.empty()) << +i;
    lookers.push_back(std::move(alone[0]));
  }
  const auto answered = [&](Looker& l) {
    Bytes record(kMaxDatagramBytes);
    record.resize(l.channel.seal(question(), record));
    s.sent.clear();
    s.observers.receive(record, l.address, now);
    return !s.sent.empty();
  };
  EXPECT_FALSE(answered(*lookers[0]));
  for (std::size_t i = 1; i < lookers.size(); ++i) EXPECT_TRUE(answered(*lookers[i])) << i;
}

TEST(ObserversWithCertificates, AnObserversCertificateLooksAndSoDoesAMasters) {
  const auto sees = [](const std::string& usage) {
    Served s(test_certificates(1, DtlsRole::server));
    s.observers.show("status");
    std::vector<std::unique_ptr<Looker>> lookers;
    lookers.push_back(
        std::make_unique<Looker>(10, test_certificates(1, Request{"test side", usage, {}})));
    TimePoint now = kNow;
    run(s, lookers, now, 300);
    return !lookers[0]->seen.empty();
  };
  EXPECT_TRUE(sees(observer_usage()));
  EXPECT_TRUE(sees("clientAuth"));
  EXPECT_FALSE(sees(kObserverUsage)) << "no client";
  EXPECT_FALSE(sees("serverAuth"));
}

INSTANTIATE_TEST_SUITE_P(Link, SecureObservers, kBothProofs, proof_name);

}  // namespace
}  // namespace farhand
