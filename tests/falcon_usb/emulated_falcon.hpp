// An emulated Falcon and who talks to it, under virtual time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "common/geometry.hpp"
#include "master/falcon_usb/emulator/emulator.hpp"

namespace farhand::falcon_usb {

using namespace std::chrono_literals;

inline constexpr TimePoint kStart{1234567s};  // any: only differences count

// Lets both live until `end`, each called when it wants to be: a shell that wakes at once. What is
// brought up to date wants to be called later.
template <Talker D>
void run(Emulator& emulator, D& talker, TimePoint& now, TimePoint end) {
  while (true) {
    pump(emulator, talker, now);
    const TimePoint next = std::min(emulator.due(), talker.due());
    ASSERT_GT(next, now);
    if (next > end) break;
    now = next;
  }
  now = end;
}

inline std::vector<std::byte> firmware_image(std::size_t size = 8492) {
  Random random(99);
  std::vector<std::byte> image(size);
  for (std::byte& b : image) b = static_cast<std::byte>(random.bits());
  return image;
}

// A grip that swings through the indices of all axes once a second, or goes to a place and rests.
struct ScriptedGrip {
  bool swings = true;
  AxisWords place{};  // when it does not
  AxisWords jump{};   // of the encoders' zero
  std::uint8_t buttons = 0;
  AxisWords driven{};  // motor counts
  std::uint64_t drives = 0;
  TimePoint last_driven{};  // when motor counts were not zero
  bool logs = false;
  struct Shown {
    TimePoint at;
    AxisWords counts;
  };
  std::vector<Shown> shown;  // encoder counts of every answer so far

  Mechanism mechanism() {
    return {.read = [this](TimePoint now) { return read(now); },
            .drive = [this](TimePoint now, const AxisWords& counts) { drive(now, counts); }};
  }

 private:
  static constexpr double kSpeed = 20e3;  // [counts/s], half of what is plausible

  void drive(TimePoint now, const AxisWords& counts) {
    driven = counts;
    ++drives;
    if (counts != AxisWords{}) last_driven = now;
  }
  GripState read(TimePoint now) {
    GripState out{.buttons = buttons};
    const double turn = 2 * std::numbers::pi * std::fmod(seconds(now - kStart), 1);
    const double reach = kSpeed * seconds(now - last_);
    for (int i = 0; i < 3; ++i) {
      const double target = swings ? 600 * std::sin(turn + i) : place[i];
      counts_[i] += std::clamp(target - counts_[i], -reach, reach);
      out.counts[i] = static_cast<std::int16_t>(std::lround(counts_[i]) + jump[i]);
    }
    last_ = now;
    if (logs) shown.push_back({now, out.counts});
    return out;
  }

  Vec3 counts_ = Vec3::Zero();
  TimePoint last_ = kStart;
};

}  // namespace farhand::falcon_usb
