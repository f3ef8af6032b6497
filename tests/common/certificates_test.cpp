#include "common/certificates.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>

#include "tests/support/rsa_authority.hpp"
#include "tests/support/temporary_file.hpp"
#include "tests/support/test_credentials.hpp"

namespace farhand {
namespace {

namespace fs = std::filesystem;

bool says(const std::string& all, const std::string& part) {
  return all.find(part) != std::string::npos;
}

// The three files of a side; each may be replaced.
struct Side {
  explicit Side(const Issued& issued) : certificate(issued) {}
  explicit Side(const Request& request) : Side(issue(test_authority(1), request)) {}
  explicit Side(const char* usage, const Lifetime& lifetime = {})
      : Side(Request{"test side", usage, lifetime}) {}

  // What is said against them, which must name one of them.
  std::string why_not(DtlsRole role = DtlsRole::client) const {
    const TemporaryFile a(authority, ".pem"), c(own, ".pem"), k(key, ".pem");
    chmod(a.path().c_str(), authority_mode);
    chmod(c.path().c_str(), 0644);
    chmod(k.path().c_str(), key_mode);
    const std::string said = refusal([&] {
      load_certificates({a.path(), c.path(), k.path()}, role);
    });
    EXPECT_TRUE(said.empty() || says(said, a.path()) || says(said, c.path()) ||
                says(said, k.path()))
        << said;
    return said;
  }

  Issued certificate;
  std::string authority = to_pem(*test_authority(1).certificate);
  std::string own = to_pem(*certificate.certificate), key = to_pem(*certificate.private_key);
  mode_t authority_mode = 0644, key_mode = 0600;
};

TEST(Certificates, AreForTheirSideOnly) {
  EXPECT_EQ(Side("clientAuth").why_not(DtlsRole::client), "");
  EXPECT_EQ(Side("serverAuth").why_not(DtlsRole::server), "");
  EXPECT_EQ(Side("clientAuth,serverAuth").why_not(DtlsRole::server), "");
  EXPECT_TRUE(says(Side("clientAuth").why_not(DtlsRole::server), "is not for a slave"));
  EXPECT_TRUE(says(Side("serverAuth").why_not(DtlsRole::client), "is not for a master"));
  for (const char* usage : {"", "codeSigning", "anyExtendedKeyUsage"})
    EXPECT_TRUE(says(Side(usage).why_not(), "is not for a master")) << usage;
}

TEST(Certificates, MustFitTogether) {
  Side side("clientAuth");
  side.key = to_pem(*test_authority(1).private_key);
  EXPECT_TRUE(says(side.why_not(), "does not fit the certificate"));
  side = Side("clientAuth");
  side.authority = to_pem(*test_authority(2).certificate);
  EXPECT_TRUE(says(side.why_not(), "is not signed by this side's authority"));
  side.authority = side.own;
  EXPECT_TRUE(says(side.why_not(), "nobody who may sign others"));
}

TEST(Certificates, MustBeValidNow) {
  const std::string over = Side("clientAuth", {.from = -10, .until = -1}).why_not();
  EXPECT_TRUE(says(over, "certificate file")) << over;
  EXPECT_TRUE(says(over, "expired on 20")) << over;
  EXPECT_TRUE(says(over, "farhand-keygen --certificates")) << over;
  const std::string to_come = Side("clientAuth", {.from = 1, .until = 10}).why_not();
  EXPECT_TRUE(says(to_come, "is not valid before 20")) << to_come;
  EXPECT_TRUE(says(to_come, "set this machine's clock")) << to_come;
}

TEST(Certificates, OnlyTheOneThatIsSentMustBeShort) {
  const Issued authority = rsa_authority();
  ASSERT_GT(i2d_X509(authority.certificate.get(), nullptr), 800);
  Side side(issue(authority, {"test side", "clientAuth", {}}));
  side.authority = to_pem(*authority.certificate);
  EXPECT_EQ(side.why_not(), "");
}

TEST(Certificates, AnAuthorityExpiresToo) {
  const Issued authority = make_authority("old", {.from = -10, .until = -1});
  Side side(issue(authority, {"test side", "clientAuth", {}}));
  side.authority = to_pem(*authority.certificate);
  EXPECT_TRUE(says(side.why_not(), "authority file"));
  EXPECT_TRUE(says(side.why_not(), "expired on"));
}

TEST(Certificates, FilesAreWhatTheyShouldBe) {
  Side side("clientAuth");
  for (const mode_t open : {0640, 0604, 0620, 0602}) {
    side.key_mode = open;
    EXPECT_TRUE(says(side.why_not(), "chmod 600")) << std::oct << open;
  }
  side = Side("clientAuth");
  for (const mode_t open : {0664, 0646}) {
    side.authority_mode = open;
    EXPECT_TRUE(says(side.why_not(), "chmod 644")) << std::oct << open;
  }
  for (const std::string& bad : {std::string(), std::string("no PEM"), side.own.substr(0, 200)}) {
    side = Side("clientAuth");
    side.authority = bad;
    EXPECT_TRUE(says(side.why_not(), "is no certificate in PEM")) << bad;
    side = Side("clientAuth");
    side.own = bad;
    EXPECT_TRUE(says(side.why_not(), "is no certificate in PEM")) << bad;
    side = Side("clientAuth");
    side.key = bad;
    EXPECT_TRUE(says(side.why_not(), "is no private key in PEM")) << bad;
  }
  side = Side("clientAuth");
  side.own += to_pem(*test_authority(1).certificate);
  EXPECT_TRUE(says(side.why_not(), "more than one certificate"));
  std::string usage = "clientAuth";
  for (int i = 0; i < 200; ++i) usage += ",1.3.6.1.4.1.99999." + std::to_string(i);
  EXPECT_TRUE(says(Side(usage.c_str()).why_not(), "longer than 800 bytes"));
}

TEST(Certificates, SaysWhichIsMissing) {
  const std::string said = refusal([] {
    load_certificates({"/nowhere/a.pem", "b", "c"}, DtlsRole::client);
  });
  EXPECT_TRUE(says(said, "authority file /nowhere/a.pem cannot be opened")) << said;
  EXPECT_TRUE(says(said, "farhand-keygen --certificates")) << said;
}

// Both made by openssl: genpkey -algorithm ed25519, and pkcs8 -topk8 of one over P-256. Nobody is
// asked for the passphrase.
TEST(Certificates, APrivateKeyOfAnotherKindIsRefused) {
  Side side("clientAuth");
  side.key =
      "-----BEGIN ENCRYPTED PRIVATE KEY-----\n"
      "MIHsMFcGCSqGSIb3DQEFDTBKMCkGCSqGSIb3DQEFDDAcBAj9ClltZKXArgICA+gw\n"
      "DAYIKoZIhvcNAgkFADAdBglghkgBZQMEASoEECgh3KPNlMooRzjBdiCi8sEEgZB4\n"
      "fTxL6Z/ysLvLBC/oaIto5ELr+V7VrsKeWOLgHUjsnwkSPMi7Yl6qW2uHRWlexLRV\n"
      "eVkNao/Jx4iyTU4NDEJ7hoV8uV+GW3YDGdNRYBe99xsRXgqvuA6Sx1OX8ZRTdVZm\n"
      "SvuKBmAjleiogRV9EdgSIbz5tubseddLQTjBipVrQexOY4fSVH0ct4GE1TcKH6g=\n"
      "-----END ENCRYPTED PRIVATE KEY-----\n";
  EXPECT_TRUE(says(side.why_not(), "without a passphrase"));
  side.key =
      "-----BEGIN PRIVATE KEY-----\n"
      "MC4CAQAwBQYDK2VwBCIEIAABAgMEBQYHCAkKCwwNDg8QERITFBUWFxgZGhscHR4f\n"
      "-----END PRIVATE KEY-----\n";
  EXPECT_TRUE(says(side.why_not(), "is not of ECDSA over P-256"));
}

class NewCertificates : public testing::Test {
 protected:
  ~NewCertificates() override { fs::remove_all(directory); }
  CertificateFiles of(const std::string& side) const {
    return {directory / "authority.pem", directory / (side + ".pem"),
            directory / (side + "_key.pem")};
  }
  const fs::path directory =
      fs::temp_directory_path() / ("farhand_certificates_" + std::to_string(getpid()));
};

TEST_F(NewCertificates, EachSideCanBeginWithItsOwn) {
  const std::string name = write_new_certificates(directory, 100);
  for (const auto& [side, role] : {std::pair{"master", DtlsRole::client},
                                   {"observer", DtlsRole::client},
                                   {"slave", DtlsRole::server}}) {
    const Certificates c = load_certificates(of(side), role);
    EXPECT_TRUE(c.name.ends_with(" of authority " + name)) << c.name;
    const double days = std::difftime(valid_until(c), std::time(nullptr)) / (24 * 3600);
    EXPECT_NEAR(days, 100, 0.1);
    struct stat about {};
    ASSERT_EQ(stat(of(side).private_key.c_str(), &about), 0);
    EXPECT_EQ(about.st_mode & 0777, 0600u);
  }
}

TEST_F(NewCertificates, NobodyCanSignMore) {
  write_new_certificates(directory, 100);
  std::set<std::string> names;
  for (const auto& file : fs::directory_iterator(directory))
    names.insert(file.path().filename().string());
  EXPECT_EQ(names,
            (std::set<std::string>{"authority.pem", "master.pem", "master_key.pem", "slave.pem",
                                   "slave_key.pem", "observer.pem", "observer_key.pem"}));
}

TEST_F(NewCertificates, NothingIsOverwrittenNorHalfMade) {
  fs::create_directories(directory);
  std::ofstream(directory / "slave.pem") << "precious";
  EXPECT_TRUE(says(refusal([&] { write_new_certificates(directory, 100); }), "exists"));
  std::string text;
  std::ifstream(directory / "slave.pem") >> text;
  EXPECT_EQ(text, "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 1);
}

// Nothing seems to be in the way before the first is written.
TEST_F(NewCertificates, AHalfMadeSetIsTakenBack) {
  fs::create_directories(directory);
  fs::create_symlink("nowhere", directory / "observer.pem");
  EXPECT_TRUE(
      says(refusal([&] { write_new_certificates(directory, 100); }), "observer.pem exists"));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace farhand
