#include "common/key_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

const std::string kDigits = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f";

std::string why_not(const std::string& text, mode_t mode = 0600) {
  const TemporaryFile file(text, ".key");
  chmod(file.path().c_str(), mode);
  const std::string said = refusal([&] { load_key(file.path()); });
  EXPECT_TRUE(said.empty() || said.find(file.path()) != std::string::npos) << said;
  return said;
}

bool says(const std::string& all, const std::string& part) {
  return all.find(part) != std::string::npos;
}

TEST(KeyFile, ReadsWhatItWrote) {
  const TemporaryFile file("", ".key");
  std::filesystem::remove(file.path());
  const Key written = write_new_key(file.path());
  const Key read = load_key(file.path());
  EXPECT_EQ(read.secret, written.secret);
  EXPECT_EQ(read.name, written.name);
  struct stat about {};
  ASSERT_EQ(stat(file.path().c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777, 0600u);
}

TEST(KeyFile, NeverOverwrites) {
  const TemporaryFile file("precious", ".key");
  EXPECT_TRUE(says(refusal([&] { write_new_key(file.path()); }), "exists"));
  std::string text;
  std::ifstream(file.path()) >> text;
  EXPECT_EQ(text, "precious");
}

TEST(KeyFile, NoTwoKeysAreAlike) {
  const TemporaryFile a("", ".key"), b("", ".key");
  std::filesystem::remove(a.path());
  std::filesystem::remove(b.path());
  EXPECT_NE(write_new_key(a.path()).secret, write_new_key(b.path()).secret);
}

// SHA-256 of the bytes 0 to 31 begins with 63 0d cd 29 (sha256sum).
TEST(KeyFile, IsOneLineOfDigitsBesideComments) {
  const TemporaryFile file("# a comment\n\n" + kDigits + "\n# another\n", ".key");
  chmod(file.path().c_str(), 0400);
  const Key key = load_key(file.path());
  for (std::size_t i = 0; i < key.secret.size(); ++i)
    EXPECT_EQ(key.secret[i], static_cast<std::byte>(i));
  EXPECT_EQ(key.name, "630dcd29");
}

TEST(KeyFile, SaysWhatIsWrongAndWhatToDo) {
  EXPECT_TRUE(says(refusal([] { load_key("/nowhere/a.key"); }), "farhand-keygen"));
  for (const mode_t open : {0640, 0604, 0620, 0602})
    EXPECT_TRUE(says(why_not(kDigits + "\n", open), "chmod 600")) << std::oct << open;
  EXPECT_TRUE(says(why_not(""), "holds no key"));
  EXPECT_TRUE(says(why_not("# only a comment\n"), "holds no key"));
  EXPECT_TRUE(says(why_not(kDigits.substr(1) + "\n"), "64 hexadecimal digits"));
  EXPECT_TRUE(says(why_not(kDigits + "0\n"), "64 hexadecimal digits"));
  EXPECT_TRUE(says(why_not("g" + kDigits.substr(1) + "\n"), "64 hexadecimal digits"));
  EXPECT_TRUE(says(why_not(kDigits + "\n" + kDigits + "\n"), "64 hexadecimal digits"));
  EXPECT_TRUE(says(why_not(std::string(5000, '#')), "holds no key"));
  EXPECT_FALSE(refusal([] { load_key("/tmp"); }).empty());
}

TEST(KeyFile, BelongsToNobodyElse) {
  constexpr uid_t kSomebodyElse = 12345;
  const TemporaryFile file(kDigits + "\n", ".key");
  chmod(file.path().c_str(), 0600);
  EXPECT_EQ(refusal([&] { load_key(file.path()); }), "");
  if (chown(file.path().c_str(), kSomebodyElse, static_cast<gid_t>(-1)) != 0)
    GTEST_SKIP() << "only root can give files away";
  const std::string said = refusal([&] { load_key(file.path()); });
  EXPECT_TRUE(says(said, "belongs to another user") && says(said, "chown")) << said;
}

TEST(KeyFile, ALongOneIsRefusedWhole) {
  EXPECT_TRUE(says(why_not(kDigits + "\n#" + std::string(16384, ' ')), "longer than 16 KiB"));
}

}  // namespace
}  // namespace farhand
