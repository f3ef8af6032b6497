// Every controller and filter over very many ticks, gains over six decades, against the same
// difference equation in long double with its sums carried exactly; and what inputs out of all
// bounds leave behind. FARHAND_STRESS_TICKS sets how many ticks.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/pid.hpp"
#include "common/random.hpp"
#include "tests/support/stress.hpp"

namespace farhand {
namespace {

constexpr double kTs = 0.001;
constexpr std::array kDecades = {1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3};

// Between -1 and 1, of mean zero, so that no integral grows for ever.
class Signal {
 public:
  double next() {
    tick_ = tick_ + 1 == 5000 ? 0 : tick_ + 1;
    const double saw = tick_ / 2500.0 - 1;
    return 0.9 * saw + 0.1 * (2 * random_.uniform() - 1);
  }

 private:
  Random random_{11};
  int tick_ = 0;
};

class Sum {
 public:
  void add(long double x) {
    const long double y = x - lost_, t = sum_ + y;
    lost_ = (t - sum_) - y;
    sum_ = t;
  }
  long double value() const { return sum_; }

 private:
  long double sum_ = 0, lost_ = 0;
};

TEST(StressedPid, RoundingStaysAtTheLastDigits) {
  const std::uint64_t ticks = stress_ticks(300'000);
  for (const double gain : kDecades) {
    const Pid pid = make_pid({.kp = gain, .ki = 3 * gain, .kd = 0.01 * gain}, kTs);
    PidState state;
    Sum I;
    Signal signal;
    long double e1 = 0;
    double worst = 0;
    for (std::uint64_t k = 0; k < ticks; ++k) {
      const double e = signal.next();
      if (k == 0) e1 = e;
      I.add(static_cast<long double>(pid.half_ki_Ts) * (e + e1));
      const long double exact = static_cast<long double>(pid.kp) * e + I.value() +
                                static_cast<long double>(pid.kd_per_Ts) * (e - e1);
      const double u = step(pid, state, e, 0);
      if (k + 1000 >= ticks) worst = std::max(worst, std::abs(static_cast<double>(u - exact)));
      e1 = e;
    }
    std::printf("PID, gains %g (1, 3 /s, 0.01 s): after %llu ticks off by %.1e of the gain\n", gain,
                static_cast<unsigned long long>(ticks), worst / gain);
    // The integral's addends, 1.5e-3 of the gain, are rounded in their last digit: a random walk.
    const double walk =
        1.5e-3 * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(ticks));
    EXPECT_LE(worst, (1e-13 + 10 * walk) * gain) << gain;
  }
}

TEST(StressedLowPass, ForgetsItsRounding) {
  const std::uint64_t ticks = stress_ticks(300'000);
  for (const double cutoff_hz : {0.01, 0.1, 1.0, 10.0, 100.0, 400.0}) {
    const double gain = low_pass_gain(cutoff_hz, kTs);
    double y = 0, worst = 0;
    long double exact = 0;
    Signal signal;
    for (std::uint64_t k = 0; k < ticks; ++k) {
      const double x = signal.next();
      y += gain * (x - y);
      exact += static_cast<long double>(gain) * (x - exact);
      if (k + 1000 >= ticks) worst = std::max(worst, std::abs(static_cast<double>(y - exact)));
    }
    std::printf("one pole, %g Hz: after %llu ticks off by %.1e\n", cutoff_hz,
                static_cast<unsigned long long>(ticks), worst);
    EXPECT_LE(worst, 1e-13) << cutoff_hz;
  }
}

TEST(StressedPid, WhateverComesInTheOutputKeepsItsLimitAndRecovers) {
  Random random(12);
  const std::uint64_t ticks = stress_ticks(300'000);
  for (const double gain : kDecades) {
    const Pid pid = make_pid({.kp = gain, .ki = gain, .kd = gain, .limit = 5}, kTs);
    PidState state;
    for (std::uint64_t k = 0; k < ticks / kDecades.size(); ++k) {
      const double size = std::pow(10.0, 620 * random.uniform() - 310);
      const double u = step(pid, state, random.normal() * size, random.normal());
      ASSERT_LE(std::abs(u), 5) << "gain " << gain << ", tick " << k;  // false for NaN
    }
    // Nothing is wound up: an error of twice the limit takes the output to the other end at once.
    const double away = state.I > 0 ? -10 / gain : 10 / gain;
    step(pid, state, away, 0);
    EXPECT_EQ(step(pid, state, away, 0), std::copysign(5, away)) << gain;
  }
}

}  // namespace
}  // namespace farhand
