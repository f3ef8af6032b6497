// What only certificates can be wrong about; what they share with a key is in the other tests of
// DTLS, which run with both.
#include <gtest/gtest.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <cstdio>

#include "common/certificate_rules.hpp"
#include "common/openssl_pointers.hpp"
#include "tests/support/dtls_ends.hpp"
#include "tests/support/rsa_authority.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

void sent_free(STACK_OF(X509) * all) {
  sk_X509_free(all);
}

Certificates certificates(const std::string& usage, const Lifetime& lifetime = {}) {
  return test_certificates(1, {"test side", usage, lifetime});
}

const Lifetime kOver{.from = -10, .until = -1}, kToCome{.from = 1, .until = 10};

// Who sees it is right about the other side, and that one is told in an alert.
void expect_mismatch(const SideCredentials& sides, Mismatch what, DtlsRole seen_by,
                     std::optional<Mismatch> said = {}) {
  DtlsEnds ends(sides);
  EXPECT_FALSE(ends.run(seconds(8)));
  EXPECT_EQ(ends.client_session, nullptr);
  EXPECT_EQ(ends.server_session, nullptr);
  const bool by_client = seen_by == DtlsRole::client;
  const auto& here = by_client ? ends.client.counters() : ends.server.counters();
  const auto& there = by_client ? ends.server.counters() : ends.client.counters();
  EXPECT_GT(here.seen[static_cast<std::size_t>(what)], 0u);
  EXPECT_GT(there.said[static_cast<std::size_t>(said.value_or(what))], 0u);
  EXPECT_EQ(here.done + there.done, 0u);
}

void expect_wrong_client(const Certificates& client, Mismatch what) {
  expect_mismatch({client, certificates("serverAuth")}, what, DtlsRole::server);
}
void expect_wrong_server(const Certificates& server, Mismatch what) {
  expect_mismatch({certificates("clientAuth"), server}, what, DtlsRole::client);
}

TEST(DtlsCertificates, EachSideKnowsWhoseItTook) {
  const Certificates client = certificates("clientAuth"), server = certificates("serverAuth");
  DtlsEnds ends({client, server});
  EXPECT_EQ(ends.client.peer_certificate(), "");
  ASSERT_TRUE(ends.run(milliseconds(10)));
  EXPECT_EQ(ends.client.peer_certificate(), fingerprint(*server.own));
  EXPECT_EQ(ends.server.peer_certificate(), fingerprint(*client.own));
}

TEST(DtlsCertificates, AStolenOneOpensNoOtherPart) {
  expect_wrong_server(certificates("clientAuth"), Mismatch::wrong_role);
  expect_wrong_client(certificates("serverAuth"), Mismatch::wrong_role);
}

TEST(DtlsCertificates, OneThatDoesNotNameItsPartHasNone) {
  for (const char* usage : {"", "codeSigning", "anyExtendedKeyUsage"}) {
    expect_wrong_server(certificates(usage), Mismatch::wrong_role);
    expect_wrong_client(certificates(usage), Mismatch::wrong_role);
  }
}

TEST(DtlsCertificates, AnObserversNeverLeads) {
  expect_wrong_client(certificates(observer_usage()), Mismatch::wrong_role);
  expect_wrong_client(certificates(observer_usage() + ",serverAuth"), Mismatch::wrong_role);
  expect_wrong_server(certificates(observer_usage() + ",serverAuth"), Mismatch::wrong_role);
}

TEST(DtlsCertificates, OneThatIsOverOrToComeIsRefused) {
  expect_wrong_server(certificates("serverAuth", kOver), Mismatch::expired);
  expect_wrong_client(certificates("clientAuth", kOver), Mismatch::expired);
  expect_wrong_server(certificates("serverAuth", kToCome), Mismatch::not_yet_valid);
  expect_wrong_client(certificates("clientAuth", kToCome), Mismatch::not_yet_valid);
}

TEST(DtlsCertificates, AnotherAuthorityIsSeenByBoth) {
  const auto ours = test_credentials(Proof::certificates, 1);
  const auto others = test_credentials(Proof::certificates, 2);
  for (const SideCredentials& sides :
       {SideCredentials{others.client, ours.server}, {ours.client, others.server}})
    expect_mismatch(sides, Mismatch::other_secret, DtlsRole::client);
}

// The authority's certificate is no secret: a stranger may take the right slave for one.
TEST(DtlsCertificates, AStrangerWhoWouldConnectIsRefused) {
  Certificates stranger = test_certificates(2, DtlsRole::client);
  stranger.authority = test_authority(1).certificate;
  expect_wrong_client(stranger, Mismatch::other_secret);
}

// Everything as in the right one but the signature.
Certificates forged(DtlsRole role) {
  Certificates out = test_certificates(1, role);
  out.own = {X509_dup(out.own.get()), X509_free};
  X509_sign(out.own.get(), test_authority(2).private_key.get(), EVP_sha256());
  return out;
}

TEST(DtlsCertificates, AForgedSignatureIsRefused) {
  expect_wrong_client(forged(DtlsRole::client), Mismatch::other_secret);
  expect_wrong_server(forged(DtlsRole::server), Mismatch::other_secret);
}

// What OpenSSL says of `own` in a client's part, as the link asks, or with chains of `depth`.
int verified(const Issued& own, const Issued& between, const Issued& authority,
             std::optional<int> depth = {}) {
  const std::unique_ptr<X509_STORE, Freed<X509_STORE_free>> store(X509_STORE_new());
  const std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>> chain(X509_STORE_CTX_new());
  const std::unique_ptr<STACK_OF(X509), Freed<sent_free>> sent(sk_X509_new_null());
  sk_X509_push(sent.get(), between.certificate.get());
  X509_STORE_add_cert(store.get(), authority.certificate.get());
  X509_STORE_CTX_init(chain.get(), store.get(), own.certificate.get(), sent.get());
  X509_VERIFY_PARAM* param = X509_STORE_CTX_get0_param(chain.get());
  EXPECT_TRUE(expect_role(param, DtlsRole::client));
  if (depth) X509_VERIFY_PARAM_set_depth(param, *depth);
  X509_verify_cert(chain.get());
  return X509_STORE_CTX_get_error(chain.get());
}

// Whoever has a certificate has no right to sign others, and an authority is no side.
TEST(DtlsCertificates, NobodyIsTwoThings) {
  const auto master = test_certificates(1, DtlsRole::client);
  const Issued between{master.own, master.private_key};
  const Issued below = issue(between, {"below", "clientAuth", {}});
  EXPECT_NE(verified(below, between, test_authority(1)), X509_V_OK);
  EXPECT_EQ(verified(below, between, test_authority(1), 5), X509_V_ERR_INVALID_CA);
  const Issued& authority = test_authority(1);
  expect_wrong_client(
      make_certificates(authority.certificate, authority.certificate, authority.private_key),
      Mismatch::wrong_role);
}

// One that may sign authorities, unlike ours.
Issued authority_of_authorities() {
  Issued out = make_authority("test authority of authorities");
  const std::unique_ptr<BASIC_CONSTRAINTS, Freed<BASIC_CONSTRAINTS_free>> any(
      BASIC_CONSTRAINTS_new());
  any->ca = 0xff;
  X509_add1_ext_i2d(out.certificate.get(), NID_basic_constraints, any.get(), 1, X509V3_ADD_REPLACE);
  X509_sign(out.certificate.get(), out.private_key.get(), EVP_sha256());
  return out;
}

TEST(DtlsCertificates, TheAuthorityItselfMustHaveSigned) {
  const Issued first = authority_of_authorities();
  const Issued between = make_authority("test authority between");
  X509_set_issuer_name(between.certificate.get(), X509_get_subject_name(first.certificate.get()));
  X509_sign(between.certificate.get(), first.private_key.get(), EVP_sha256());
  const Issued below = issue(between, {"below", "clientAuth", {}});
  EXPECT_EQ(verified(below, between, first, 5), X509_V_OK);
  EXPECT_NE(verified(below, between, first), X509_V_OK);
  EXPECT_EQ(verified(issue(first, {"side", "clientAuth", {}}), between, first), X509_V_OK);
}

TEST(DtlsCertificates, AKeyOnOneSideAndCertificatesOnTheOtherNeverConnect) {
  const auto keys = test_credentials(Proof::key, 1);
  const auto certificates = test_credentials(Proof::certificates, 1);
  for (const SideCredentials& sides :
       {SideCredentials{keys.client, certificates.server}, {certificates.client, keys.server}})
    expect_mismatch(sides, Mismatch::other_kind, DtlsRole::server);
}

// `more` object identifiers beside the one that counts make it long.
Certificates long_one(DtlsRole role, int more) {
  std::string usage = usage_of(role);
  for (int i = 0; i < more; ++i) usage += ",1.3.6.1.4.1.99999." + std::to_string(100 + i);
  return certificates(usage);
}
SideCredentials long_ones(int more) {
  return {long_one(DtlsRole::client, more), long_one(DtlsRole::server, more)};
}

TEST(DtlsCertificates, AFlightWithTheLongestOneIsOneDatagram) {
  const SideCredentials sides = long_ones(33);
  const int size = i2d_X509(std::get<Certificates>(sides.client).own.get(), nullptr);
  ASSERT_GT(size, 780);
  ASSERT_LE(size, 800);
  DtlsEnds ends(sides);
  ASSERT_TRUE(ends.run(milliseconds(10)));
  EXPECT_EQ(ends.client_sent.size(), 3u);
  EXPECT_EQ(ends.server_sent.size(), 3u);
  std::printf("flights of %zu and %zu bytes\n", ends.client_sent.back().size(),
              ends.server_sent[1].size());
}

TEST(DtlsCertificates, AnAuthorityOfRsaWithALongOneDoes) {
  const Issued authority = rsa_authority();
  ASSERT_GT(i2d_X509(authority.certificate.get(), nullptr), 800);
  const auto side = [&](const char* usage) {
    const Issued own = issue(authority, {"test side", usage, {}});
    return make_certificates(authority.certificate, own.certificate, own.private_key);
  };
  DtlsEnds ends({side("clientAuth"), side("serverAuth")});
  EXPECT_TRUE(ends.run(milliseconds(10)));
}

TEST(DtlsCertificates, OneTooLongIsNotTaken) {
  for (const SideCredentials& sides :
       {SideCredentials{long_one(DtlsRole::client, 40), certificates("serverAuth")},
        {certificates("clientAuth"), long_one(DtlsRole::server, 40)}}) {
    DtlsEnds ends(sides);
    EXPECT_FALSE(ends.run(seconds(8)));
    EXPECT_EQ(ends.client_session, nullptr);
    EXPECT_EQ(ends.server_session, nullptr);
  }
}

}  // namespace
}  // namespace farhand
