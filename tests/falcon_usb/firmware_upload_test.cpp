#include "master/falcon_usb/firmware_upload.hpp"

#include <gtest/gtest.h>

#include "tests/falcon_usb/emulated_falcon.hpp"

namespace farhand::falcon_usb {
namespace {

// The upload by itself, without a driver around it.
struct Uploader {
  FirmwareUpload upload;
  bool busy = false;

  void hear(const Event& event, TimePoint now) noexcept {
    if (event.kind == EventKind::sent) busy = false;
    if (event.kind == EventKind::received) upload.hear(payload(event.packet), now);
  }
  std::optional<Request> next(TimePoint now) noexcept {
    if (busy) return {};
    const auto request = upload.next(now);
    busy = request.has_value();
    return request;
  }
  TimePoint due() const noexcept { return busy ? TimePoint::max() : upload.due(); }
};

struct Upload {
  explicit Upload(EmulatorConfig config = {}, UploadConfig upload = {})
      : emulator(config, grip.mechanism()), uploader{{upload, image, now}} {
    emulator.plug(now);
  }
  bool ended() const { return uploader.upload.succeeded() || uploader.upload.failed(); }
  // Lives until the upload has ended; how long that took.
  Duration finish() {
    while (!ended()) run(emulator, uploader, now, now + 1ms);
    return now - kStart;
  }

  const std::vector<std::byte> image = firmware_image();
  ScriptedGrip grip;
  TimePoint now = kStart;
  Emulator emulator;
  Uploader uploader;
};

EmulatorConfig wrong_echo(double ratio, std::uint64_t seed = 1) {
  return {.processor = {.faults = {.echo_wrong = ratio}}, .seed = seed};
}

TEST(FirmwareUpload, RunsTheFirmwareInWellUnderTheTimeOfOneAttempt) {
  Upload u;
  const Duration taken = u.finish();
  EXPECT_TRUE(u.uploader.upload.succeeded());
  EXPECT_TRUE(u.emulator.processor().running());
  EXPECT_EQ(u.uploader.upload.attempt(), 1);
  EXPECT_EQ(u.uploader.upload.progress(), 1);
  // 8492 bytes of ten bits at 142 857 baud are the floor.
  EXPECT_GT(taken, 594ms);
  EXPECT_LT(taken, 1s);
}

TEST(FirmwareUpload, TheGreetingsAnswerMayBeginWithAZero) {
  Upload u({.processor = {.zero_before_greeting = true}});
  u.finish();
  EXPECT_TRUE(u.emulator.processor().running());
  EXPECT_EQ(u.uploader.upload.attempt(), 1);
}

TEST(FirmwareUpload, AnotherSizeEndsAsWell) {
  for (const std::size_t size : {1u, 62u, 63u, 124u}) {
    const auto image = firmware_image(size);
    Upload u({.processor = {.firmware_bytes = size}});
    u.uploader.upload = {{}, image, u.now};
    u.finish();
    EXPECT_TRUE(u.emulator.processor().running()) << size;
  }
}

TEST(FirmwareUpload, OneWrongByteInAHundredFailsWithTheReasonAndInTime) {
  Upload u(wrong_echo(0.01));
  EXPECT_LT(u.finish(), UploadConfig{}.attempts * UploadConfig{}.attempt_time);
  EXPECT_TRUE(u.uploader.upload.failed());
  EXPECT_EQ(u.uploader.upload.fault(), UploadFault::echo_wrong);
  EXPECT_EQ(u.uploader.upload.attempt(), UploadConfig{}.attempts);
  EXPECT_FALSE(u.emulator.processor().running());
}

// An attempt is clean with 0.99^137 = 0.25, one of eight with 0.90. 45 of 50 less four times the
// deviation of 2.1 is the least.
TEST(FirmwareUpload, OneWrongPacketInAHundredMostlySucceedsAndNeverOnAWrongEcho) {
  int succeeded = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Upload u(wrong_echo(0.01 / 62, seed));
    ASSERT_LT(u.finish(), UploadConfig{}.attempts * UploadConfig{}.attempt_time) << seed;
    ASSERT_EQ(u.uploader.upload.succeeded(), u.emulator.processor().running()) << seed;
    if (u.uploader.upload.failed()) {
      ASSERT_EQ(u.uploader.upload.fault(), UploadFault::echo_wrong);
    }
    succeeded += u.uploader.upload.succeeded();
  }
  EXPECT_GE(succeeded, 37);
}

TEST(FirmwareUpload, WithoutPowerThereIsNoBootLoader) {
  Upload u;
  u.emulator.cut_power();
  EXPECT_LE(u.finish(), UploadConfig{}.attempts * UploadConfig{}.attempt_time + 1ms);
  EXPECT_TRUE(u.uploader.upload.failed());
  EXPECT_EQ(u.uploader.upload.fault(), UploadFault::no_greeting);
}

TEST(FirmwareUpload, PowerLostHalfWayIsSaidAtOnce) {
  Upload u({}, {.attempts = 1});
  while (u.uploader.upload.progress() < 0.5) run(u.emulator, u.uploader, u.now, u.now + 1ms);
  u.emulator.cut_power();
  const TimePoint cut = u.now;
  u.finish();
  EXPECT_EQ(u.uploader.upload.fault(), UploadFault::echo_missing);
  EXPECT_LE(u.now - cut, UploadConfig{}.answer_time + 1ms);
}

// The greeting's answer came late, the one to the 'A' not at all.
TEST(FirmwareUpload, AnAttemptsTimeEndsItInEveryStep) {
  const auto image = firmware_image(10);
  FirmwareUpload upload({.attempts = 1, .attempt_time = 60ms}, image, kStart);
  const auto ask_all = [&](TimePoint now) {
    while (upload.next(now)) continue;
    EXPECT_GT(upload.due(), now);
  };
  ask_all(kStart);
  upload.hear(std::as_bytes(std::span("\x0a\x44\x2c\x0d", 4)), kStart + 40ms);
  ask_all(kStart + 40ms);
  EXPECT_FALSE(upload.failed());
  ask_all(kStart + 61ms);
  EXPECT_TRUE(upload.failed());
  EXPECT_EQ(upload.fault(), UploadFault::no_fast_mode);
}

TEST(FirmwareUpload, AnEmptyImageIsRefused) {
  const FirmwareUpload upload({}, {}, kStart);
  EXPECT_TRUE(upload.failed());
  EXPECT_EQ(upload.fault(), UploadFault::no_image);
}

}  // namespace
}  // namespace farhand::falcon_usb
