// Records: nothing is accepted that was not sealed by the other end of this very session, and
// nothing twice; and neither good nor bad ones cost an allocation.
#include <gtest/gtest.h>
#include <openssl/crypto.h>

#include <algorithm>
#include <cstdio>

#include "common/dtls.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/both_proofs.hpp"
#include "tests/support/dtls_ends.hpp"
#include "tests/support/stress.hpp"

namespace farhand {
namespace {

// OpenSSL's own allocator must count too, in case it ever keeps memory of its own.
void* counted_malloc(std::size_t n, const char*, int) {
  return std::malloc(n);
}
void* counted_realloc(void* p, std::size_t n, const char*, int) {
  return std::realloc(p, n);
}
void counted_free(void* p, const char*, int) {
  std::free(p);
}
const int kOpensslCounts = CRYPTO_set_mem_functions(counted_malloc, counted_realloc, counted_free);

std::uint64_t attempts() {
  return stress_ticks(100000);
}

class DtlsRecord : public testing::TestWithParam<Proof> {
 protected:
  DtlsRecord() { connect(ends); }

  static void connect(DtlsEnds& e) {
    if (!e.run(std::chrono::milliseconds(10))) throw std::runtime_error("does not connect");
  }
  Opened open(std::span<const std::byte> datagram) {
    return ends.server_session->open(datagram, opened);
  }
  Bytes record(std::uint64_t seed, std::size_t size = 200) {
    return sealed(*ends.client_session, some_payload(seed, size));
  }
  void expect_still_works() { EXPECT_EQ(open(record(999)).verdict, Verdict::accepted); }

  DtlsEnds ends{test_credentials(GetParam(), 1)};
  std::array<std::byte, kMaxPayloadBytes> opened{};
};

TEST_P(DtlsRecord, CarriesEverySizeThatAPayloadMayHave) {
  for (std::size_t size = 1; size <= kMaxPayloadBytes; ++size) {
    const Bytes payload = some_payload(size, size);
    const Bytes datagram = sealed(*ends.client_session, payload);
    ASSERT_EQ(datagram.size(), size + kDtlsHeaderBytes + kDtlsTagBytes);
    const Opened got = open(datagram);
    ASSERT_EQ(got.verdict, Verdict::accepted);
    ASSERT_EQ(got.size, size);
    ASSERT_TRUE(std::equal(payload.begin(), payload.end(), opened.begin()));
  }
  EXPECT_TRUE(sealed(*ends.client_session, {}).empty());
  EXPECT_TRUE(sealed(*ends.client_session, Bytes(kMaxPayloadBytes + 1)).empty());
  Bytes small(100);
  EXPECT_EQ(ends.client_session->seal(Bytes(100), small), 0u);
}

TEST_P(DtlsRecord, NoFlippedBitIsAccepted) {
  const Bytes good = record(1);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    ASSERT_NE(open(bad).verdict, Verdict::accepted) << "bit " << bit;
  }
  EXPECT_EQ(open(good).verdict, Verdict::accepted) << "the good one was not used up";
}

TEST_P(DtlsRecord, NoTwoFlippedBitsAreAccepted) {
  const Bytes good = record(1);
  const std::size_t bits = 8 * good.size();
  const bool all = attempts() > 1000000;  // every pair, else as many at random
  Random random(2);
  std::uint64_t tried = 0;
  const auto flipped = [&](std::size_t a, std::size_t b) {
    Bytes bad = good;
    bad[a / 8] ^= std::byte{1} << (a % 8);
    bad[b / 8] ^= std::byte{1} << (b % 8);
    ++tried;
    return open(bad).verdict;
  };
  for (std::size_t a = 0; all && a < bits; ++a)
    for (std::size_t b = 0; b < a; ++b) ASSERT_NE(flipped(a, b), Verdict::accepted);
  while (tried < attempts() && !all) {
    const std::size_t a = random.bits() % bits, b = random.bits() % bits;
    if (a == b) continue;
    ASSERT_NE(flipped(a, b), Verdict::accepted);
  }
  EXPECT_EQ(open(good).verdict, Verdict::accepted);
}

TEST_P(DtlsRecord, NothingIsOpenedTwice) {
  std::vector<Bytes> sent;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    sent.push_back(record(i));
    ASSERT_EQ(open(sent.back()).verdict, Verdict::accepted);
  }
  Random random(3);
  for (std::uint64_t i = 0; i < attempts(); ++i)
    ASSERT_EQ(open(sent[random.bits() % sent.size()]).verdict, Verdict::not_authentic);
  expect_still_works();
}

TEST_P(DtlsRecord, ALateOneIsOpenedOnceIfNotTooLate) {
  std::vector<Bytes> sent;
  for (std::uint64_t i = 0; i < 65; ++i) sent.push_back(record(i));
  EXPECT_EQ(open(sent[64]).verdict, Verdict::accepted);
  EXPECT_EQ(open(sent[0]).verdict, Verdict::not_authentic);
  for (std::size_t i = 1; i < 64; ++i) {
    EXPECT_EQ(open(sent[i]).verdict, Verdict::accepted) << i;
    EXPECT_EQ(open(sent[i]).verdict, Verdict::not_authentic) << i;
  }
}

TEST_P(DtlsRecord, NeitherAnOldSessionNorAForeignKeyIsHeard) {
  DtlsEnds old(test_credentials(GetParam(), 1)), foreign(test_credentials(GetParam(), 2));
  connect(old);
  connect(foreign);
  const Bytes payload = some_payload(4);
  for (std::uint64_t i = 0; i < attempts(); ++i) {
    ASSERT_EQ(open(sealed(*old.client_session, payload)).verdict, Verdict::not_authentic);
    ASSERT_EQ(open(sealed(*foreign.client_session, payload)).verdict, Verdict::not_authentic);
  }
  expect_still_works();
}

TEST_P(DtlsRecord, OwnRecordsAreNotHeard) {
  for (std::uint64_t i = 0; i < 1000; ++i)
    ASSERT_EQ(open(sealed(*ends.server_session, some_payload(i))).verdict, Verdict::not_authentic);
  expect_still_works();
}

TEST_P(DtlsRecord, NoForgeryIsAccepted) {
  Random random(5);
  for (std::uint64_t i = 0; i < attempts(); ++i) {
    Bytes forged = some_payload(i, 30 + random.bits() % 300);
    forged[0] = std::byte{23};
    forged[1] = std::byte{0xfe};
    forged[2] = std::byte{0xfd};
    forged[3] = std::byte{0};
    forged[4] = std::byte{1};
    if (i % 2 == 0) std::fill_n(forged.begin() + 5, 5, std::byte{0});  // a likely number
    forged[11] = static_cast<std::byte>((forged.size() - 13) >> 8);
    forged[12] = static_cast<std::byte>((forged.size() - 13) & 255);
    ASSERT_EQ(open(forged).verdict, Verdict::not_authentic);
  }
  expect_still_works();
}

TEST_P(DtlsRecord, TheHeaderSaysWhy) {
  const Bytes good = record(1);
  const auto with = [&](std::size_t at, int value) {
    Bytes b = good;
    b[at] = static_cast<std::byte>(value);
    return open(b).verdict;
  };
  EXPECT_EQ(open(std::span(good).first(29)).verdict, Verdict::too_short);
  EXPECT_EQ(open(Bytes(kMaxDatagramBytes + 1)).verdict, Verdict::too_long);
  EXPECT_EQ(with(1, 0xfd), Verdict::bad_magic);
  EXPECT_EQ(with(2, 0xff), Verdict::bad_magic);
  for (const int type : {0, 20, 21, 22, 24, 255}) EXPECT_EQ(with(0, type), Verdict::wrong_content);
  EXPECT_EQ(with(4, 0), Verdict::wrong_epoch);
  EXPECT_EQ(with(4, 2), Verdict::wrong_epoch);
  EXPECT_EQ(with(12, 0), Verdict::bad_length);
  EXPECT_EQ(open(std::span(good).first(good.size() - 1)).verdict, Verdict::bad_length);
  EXPECT_EQ(with(10, 99), Verdict::not_authentic);
  EXPECT_EQ(with(40, std::to_integer<int>(good[40]) ^ 1), Verdict::not_authentic);
  EXPECT_EQ(open(good).verdict, Verdict::accepted);
}

TEST_P(DtlsRecord, CostsNoAllocationGoodOrBad) {
  ASSERT_EQ(kOpensslCounts, 1);
  ASSERT_GT(allocations_in([] { DtlsEnds other(test_credentials(GetParam(), 1)); }), 100u)
      << "OpenSSL's are not counted";
  const Bytes payload = some_payload(1);
  Bytes datagram(kMaxDatagramBytes), forged = record(2);
  forged.back() ^= std::byte{1};
  bool right = true;
  const auto count = allocations_in([&] {
    for (int i = 0; i < 1000; ++i) {
      const std::size_t size = ends.client_session->seal(payload, datagram);
      right &= open(std::span(datagram).first(size)).verdict == Verdict::accepted;
      right &= open(std::span(datagram).first(size)).verdict == Verdict::not_authentic;
      right &= open(forged).verdict == Verdict::not_authentic;
      right &= open(std::span(forged).first(40)).verdict == Verdict::bad_length;
    }
  });
  EXPECT_EQ(count, 0u);
  EXPECT_TRUE(right);
}

// The time is printed, not judged.
TEST_P(DtlsRecord, SealsAndOpens) {
  constexpr int kBatch = 100;
  const Bytes payload = some_payload(1);
  Bytes datagram(kMaxDatagramBytes);
  std::vector<double> ns;
  for (int batch = 0; batch < 200; ++batch) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kBatch; ++i) {
      const std::size_t size = ends.client_session->seal(payload, datagram);
      ASSERT_EQ(open(std::span(datagram).first(size)).verdict, Verdict::accepted);
    }
    const Duration took = std::chrono::steady_clock::now() - begin;
    ns.push_back(static_cast<double>(took.count()) / kBatch);
  }
  std::sort(ns.begin(), ns.end());
  std::printf("%zu bytes sealed and opened: median %.0f ns, least %.0f ns\n", payload.size(),
              ns[ns.size() / 2], ns.front());
}

INSTANTIATE_TEST_SUITE_P(Link, DtlsRecord, kBothProofs, proof_name);

}  // namespace
}  // namespace farhand
