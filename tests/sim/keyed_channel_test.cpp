#include "tests/sim/keyed_channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace farhand {
namespace {

using Bytes = std::vector<std::byte>;

Bytes copy(std::span<const std::byte> b) {
  return {b.begin(), b.end()};
}

class KeyedChannelTest : public ::testing::Test {
 protected:
  KeyedChannelTest() { connect(); }

  void connect() {
    now_ += std::chrono::seconds(1);
    slave_.open(master_.due(now_), now_);
    master_.open(slave_.due(now_), now_);
  }
  Bytes sealed() { return copy(master_.seal(message_)); }
  bool is_message(std::span<const std::byte> b) const { return std::ranges::equal(b, message_); }
  bool accepted(const Bytes& frame) { return is_message(slave_.open(frame, now_)); }

  KeyedChannel master_{Role::master, 1}, slave_{Role::slave, 2};
  TimePoint now_{};
  Bytes message_ = Bytes(300, std::byte{7});
};

TEST_F(KeyedChannelTest, CarriesWhatIsGivenOnce) {
  const Bytes frame = sealed();
  EXPECT_TRUE(accepted(frame));
  EXPECT_FALSE(accepted(frame));
  const Bytes first = sealed(), second = sealed();
  EXPECT_TRUE(accepted(second));
  EXPECT_TRUE(accepted(first));
}

TEST_F(KeyedChannelTest, RefusesEveryFlippedBitAndEveryOtherLength) {
  const Bytes frame = sealed();
  for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
    Bytes bad = frame;
    bad[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    ASSERT_TRUE(slave_.open(bad, now_).empty()) << bit;
  }
  for (std::size_t size = 0; size < frame.size(); ++size)
    ASSERT_TRUE(slave_.open(std::span(frame).first(size), now_).empty()) << size;
  EXPECT_TRUE(accepted(frame));
}

TEST_F(KeyedChannelTest, RefusesItsOwnFramesSentBack) {
  EXPECT_TRUE(accepted(sealed()));
  const Bytes answer = copy(slave_.seal(message_));
  EXPECT_TRUE(slave_.open(answer, now_).empty());
  EXPECT_TRUE(is_message(master_.open(answer, now_)));
}

TEST_F(KeyedChannelTest, ANewConnectionRefusesFramesOfTheOldOne) {
  EXPECT_TRUE(accepted(sealed()));
  const Bytes old = sealed();
  connect();
  EXPECT_TRUE(accepted(sealed()));
  EXPECT_FALSE(accepted(old));
}

TEST_F(KeyedChannelTest, AReplayedRequestLeavesTheConnectionAsItIs) {
  KeyedChannel another(Role::master, 3);
  EXPECT_TRUE(accepted(sealed()));
  slave_.open(another.due(now_), now_);
  EXPECT_TRUE(accepted(sealed()));
  EXPECT_FALSE(slave_.seal(message_).empty());
}

TEST_F(KeyedChannelTest, ARestartedSlaveIsReachedAfterTheSilence) {
  EXPECT_TRUE(accepted(sealed()));
  slave_ = KeyedChannel(Role::slave, 4);
  EXPECT_FALSE(accepted(sealed()));
  EXPECT_TRUE(slave_.seal(message_).empty());
  connect();
  EXPECT_TRUE(accepted(sealed()));
}

}  // namespace
}  // namespace farhand
