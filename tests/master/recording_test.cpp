#include "master/recording.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

Recording read_text(const std::string& text) {
  return read_recording(TemporaryFile(text).path());
}

TEST(Recording, TimeStartsAtZeroAndNumbersAreKept) {
  const Recording r = read_text("t_s,x_m,y_m,z_m\n5.5,0.1,-0.2,3e-1\n5.75,0.5,0.6,0.7\n");
  ASSERT_EQ(r.t.size(), 2u);
  EXPECT_EQ(r.t[0], 0);
  EXPECT_EQ(r.t[1], 0.25);
  EXPECT_EQ(r.p[0], Vec3(0.1, -0.2, 0.3));
  EXPECT_EQ(r.p[1], Vec3(0.5, 0.6, 0.7));
  EXPECT_TRUE(r.q.empty());
}

TEST(Recording, QuaternionsAreUnitAndContinuousInSign) {
  const Recording r = read_text(
      "t_s,x_m,y_m,z_m,qw,qx,qy,qz,fx_n,fy_n,fz_n\r\n"
      "0,0,0,0,0.9999,0.01,0,0,1,2,3\r\n"
      "0.1,0,0,0,-0.9999,-0.02,0,0,1,2,3\r\n");
  ASSERT_EQ(r.q.size(), 2u);
  EXPECT_NEAR(r.q[1].norm(), 1, 1e-15);
  EXPECT_GT(r.q[0].dot(r.q[1]), 0.99);
}

TEST(Recording, EveryHeaderOfTheFormatIsRead) {
  const std::string row = "0,1,2,3", q = ",1,0,0,0", f = ",0,0,0", h = "t_s,x_m,y_m,z_m";
  const std::string hq = ",qw,qx,qy,qz", hf = ",fx_n,fy_n,fz_n";
  EXPECT_EQ(read_text(h + "\n" + row + "\n1" + row + "\n").p.size(), 2u);
  EXPECT_EQ(read_text(h + hq + "\n" + row + q + "\n1" + row + q).q.size(), 2u);
  EXPECT_EQ(read_text(h + hf + "\n" + row + f + "\n1" + row + f).q.size(), 0u);
  EXPECT_EQ(read_text(h + hq + hf + "\n" + row + q + f + "\n1" + row + q + f).q.size(), 2u);
}

struct Bad {
  const char* place;
  const char* says;
};

TEST(Recording, WhatIsNotTheFormatIsRefusedWithPlaceAndReason) {
  const std::string h = "t_s,x_m,y_m,z_m\n", hq = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  const std::vector<std::pair<std::string, Bad>> cases{
      {"", {": ", "header"}},
      {"time,x,y,z\n0,0,0,0\n", {":1:", "header"}},
      {"\xEF\xBB\xBF" + h, {":1:", "header"}},
      {"t_s,x_m,y_m,z_m,extra\n", {":1:", "header"}},
      {"t_s,x_m,y_m,z_m,fx_n,fy_n,fz_n,qw,qx,qy,qz\n", {":1:", "header"}},
      {h, {":1:", "at least two"}},
      {h + "0,0,0,0\n", {":2:", "at least two"}},
      {h + "0,0,0,0\n1,0,0\n", {":3:", "3 columns where the header has 4"}},
      {h + "0,0,0,0\n1,0,0,0,0\n", {":3:", "5 columns"}},
      {h + "0,0,0,0\n\n1,0,0,0\n", {":3:", "1 columns"}},
      {h + "0,0,0,0\n0,0,0,0\n", {":3:", "does not increase"}},
      {h + "1,0,0,0\n0.5,0,0,0\n", {":3:", "does not increase"}},
      {h + "0,0,nan,0\n", {":2:", "'nan'"}},
      {h + "0,0,inf,0\n", {":2:", "'inf'"}},
      {h + "0,0,1e999,0\n", {":2:", "'1e999'"}},
      {h + "0,0,1e300,0\n", {":2:", "'1e300'"}},
      {h + "0,0,,0\n", {":2:", "''"}},
      {h + "0,0, 1,0\n", {":2:", "' 1'"}},
      {h + "0,0,1.5m,0\n", {":2:", "'1.5m'"}},
      {h + "0,0,0,\n", {":2:", "''"}},
      {h + "0,0,0,0\n3601,0,0,0\n", {":3:", "lasts more than"}},
      {hq + "0,0,0,0,1,1,0,0\n", {":2:", "quaternion"}},
      {hq + "0,0,0,0,0,0,0,0\n", {":2:", "quaternion"}}};
  for (const auto& [text, bad] : cases) {
    const TemporaryFile file(text);
    const std::string why = refusal([&] { read_recording(file.path()); });
    EXPECT_TRUE(why.starts_with(file.path() + bad.place)) << text << " -> " << why;
    EXPECT_NE(why.find(bad.says), std::string::npos) << text << " -> " << why;
  }
}

TEST(Recording, WhatIsNoFileIsRefusedByName) {
  EXPECT_NE(refusal([] { read_recording("/nowhere/at/all.csv"); }).find("/nowhere/at/all.csv: "),
            std::string::npos);
  EXPECT_NE(refusal([] { read_recording("/"); }).find("cannot be opened"), std::string::npos);
}

TEST(Recording, AHugeFileIsRefusedBeforeItIsRead) {
  const TemporaryFile file("t_s,x_m,y_m,z_m\n");
  std::filesystem::resize_file(file.path(), kLargestRecording + 1);  // sparse
  EXPECT_NE(refusal([&] { read_recording(file.path()); }).find("256 MB"), std::string::npos);
}

}  // namespace
}  // namespace farhand
