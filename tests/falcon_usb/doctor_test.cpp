// The doctor on a Falcon, given what the USB would show.
#include "master/falcon_usb/doctor.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_file.hpp"

namespace farhand::falcon_usb {
namespace {

using doctor::Level;

void expect(const doctor::Finding& f, Level level, const std::string& part) {
  EXPECT_EQ(f.level, level) << f.text;
  EXPECT_NE(f.text.find(part), std::string::npos) << f.text;
}

Found falcon(const std::string& serial, Refusal refusal = Refusal::none) {
  return {.bus = 1, .address = 7, .refusal = refusal, .serial = serial};
}

TEST(FalconDoctor, NoFalconIsAProblem) {
  expect(device({}, ""), Level::problem, "none on the USB (0403:cb48): plug it in");
}

TEST(FalconDoctor, OneThatOpensIsGoodAndNamed) {
  expect(device({falcon("A")}, ""), Level::ok, "serial A on bus 1 device 7, can be opened");
  expect(device({falcon("B"), falcon("A")}, "A"), Level::ok, "serial A");
}

TEST(FalconDoctor, RefusalsComeWithTheirRemedy) {
  expect(device({falcon("", Refusal::permission)}, ""), Level::problem,
         "this user may not open it; install the udev rule");
  expect(device({falcon("", Refusal::permission)}, "A"), Level::problem, "plugdev");
  expect(device({falcon("A", Refusal::busy)}, "A"), Level::problem,
         "another program has it open; end the other program");
}

TEST(FalconDoctor, OfTwoTheOneThatOpensCounts) {
  expect(device({falcon("", Refusal::busy), falcon("A")}, ""), Level::ok, "serial A");
}

TEST(FalconDoctor, AnotherSerialNumberIsAProblem) {
  expect(device({falcon("B")}, "A"), Level::problem, "no serial A, but serial B on bus 1");
}

TEST(FalconDoctor, ADriverOfTheKernelsIsAWarning) {
  Found bound = falcon("A");
  bound.kernel_driver = true;
  expect(device({bound}, ""), Level::warning, "lsusb -t");
}

Scene with(const std::string& falcon_usb) {
  return parse_scene("master { falcon {} falcon_usb { " + falcon_usb + " } position_control {} }",
                     "test");
}

TEST(FalconDoctor, AFirmwareFileIsThereAndOfItsSize) {
  expect(firmware(with("")), Level::ok, "no file named");
  const TemporaryFile file("12345678", ".bin");
  expect(firmware(with("firmware_file: \"" + file.path() + "\"")), Level::ok, "8 bytes");
  expect(firmware(with("firmware_file: \"/no/such.bin\"")), Level::problem,
         "/no/such.bin cannot be read; give the Falcon's image");
}

TEST(FalconDoctor, ASceneWithoutOneIsNotLookedAt) {
  EXPECT_TRUE(
      examine(parse_scene("master { falcon {} sim_hand {} position_control {} }", "test")).empty());
}

}  // namespace
}  // namespace farhand::falcon_usb
