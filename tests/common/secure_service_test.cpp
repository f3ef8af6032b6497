#include "common/secure_service.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

constexpr const char* kOwn = "certificate 01234567 of authority 89abcdef";
constexpr DtlsRole kMaster = DtlsRole::client, kSlave = DtlsRole::server;

struct Case {
  Mismatch mismatch;
  bool seen;
  DtlsRole role;
  const char* begins;
};

// What only the other side can see is what it says, since anyone may have said it.
TEST(SecureService, SaysWhatItSawAndWhatItWasTold) {
  for (
      const Case& c : {
          Case{Mismatch::other_secret, true, kMaster,
               "the slave has a certificate of another authority than this side (certificate 0123"},
          {Mismatch::other_secret, false, kMaster,
           "the slave says that it has a certificate of another authority than this side ("},
          {Mismatch::other_secret, false, kSlave,
           "a master that would connect says that it has a certificate of another authority "},
          {Mismatch::other_kind, true, kSlave,
           "a master that would connect proves itself otherwise than this side ("},
          {Mismatch::other_kind, false, kMaster,
           "the slave says that it proves itself otherwise than this side ("},
          {Mismatch::expired, true, kMaster, "the certificate of the slave has expired: "},
          {Mismatch::expired, false, kSlave,
           "a master that would connect says that the certificate of this side has expired: "},
          {Mismatch::not_yet_valid, true, kSlave,
           "the certificate of a master that would connect is not valid yet: set the clocks"},
          {Mismatch::not_yet_valid, false, kMaster,
           "the slave says that the certificate of this side is not valid yet: set the clocks"},
          {Mismatch::wrong_role, true, kMaster, "the certificate of the slave is not a slave's: "},
          {Mismatch::wrong_role, true, kSlave,
           "the certificate of a master that would connect is not a master's: "},
          {Mismatch::wrong_role, false, kMaster,
           "the slave says that the certificate of this side is not a master's: "},
          {Mismatch::wrong_role, false, kSlave,
           "a master that would connect says that the certificate of this side is not a slave's: "},
      }) {
    const std::string said = sentence(c.mismatch, c.seen, c.role, kOwn);
    EXPECT_TRUE(said.starts_with(c.begins)) << said;
  }
  EXPECT_TRUE(sentence(Mismatch::other_secret, false, kMaster, "key 01234567")
                  .starts_with("the slave says that it has another key than this side (01234567)"));
}

TEST(SecureService, TellsAtOnceAndThenOnceAMinute) {
  Seldom seldom;
  TimePoint now{std::chrono::hours(1)};
  EXPECT_FALSE(seldom.due(0, now));
  int told = 0;
  for (std::uint64_t second = 0; second < 150; ++second, now += std::chrono::seconds(1))
    told += seldom.due(second / 2 + 1, now) ? 1 : 0;
  EXPECT_EQ(told, 3);  // at 0, 60 and 120 s
  now += std::chrono::hours(1);
  EXPECT_TRUE(seldom.due(100, now));
  now += std::chrono::hours(1);
  EXPECT_FALSE(seldom.due(100, now)) << "nothing new";
}

}  // namespace
}  // namespace farhand
