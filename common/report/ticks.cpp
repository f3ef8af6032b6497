#include "common/report/ticks.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "common/report/text.hpp"

namespace farhand {
namespace {

// An end of the range that rounding put a hair beyond a multiple still gets its tick.
constexpr double kHair = 1e-9;

double nice_step(double span, int most) {
  const double power = std::pow(10.0, std::floor(std::log10(span / most)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (std::floor(span / (factor * power) + kHair) + 1 <= most) return factor * power;
  return 20 * power;
}

std::string log_label(double value, int exponent) {
  if (exponent >= -3 && exponent <= 4) return fixed(value, std::max(0, -exponent));
  return fmt::format("1e{}", exponent);
}

}  // namespace

std::vector<Tick> linear_ticks(double lo, double hi, int most) {
  std::vector<Tick> ticks;
  if (!std::isfinite(hi - lo) || !(hi > lo) || most < 1) return ticks;
  const double step = nice_step(hi - lo, most);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + kHair)));
  const double first = std::ceil(lo / step - kHair);
  for (double i = first; i * step <= hi + kHair * step && ticks.size() < 1000; ++i)
    ticks.push_back({i * step, fixed(i * step, decimals)});
  return ticks;
}

std::vector<Tick> log_ticks(double lo, double hi, int most) {
  std::vector<Tick> ticks;
  if (!(lo > 0) || !(hi > lo) || !std::isfinite(hi)) return ticks;
  const double decades = std::log10(hi / lo);
  const int each = std::max(1, static_cast<int>(std::ceil(decades / std::max(most, 1))));
  const int last = static_cast<int>(std::floor(std::log10(hi) + kHair));
  for (int e = static_cast<int>(std::floor(std::log10(lo) + kHair)); e <= last; ++e)
    for (int digit = 1; digit <= 9; ++digit) {
      const double at = digit * std::pow(10.0, e);
      if (at < lo * (1 - kHair) || at > hi * (1 + kHair)) continue;
      const bool named =
          digit == 1 ? e % each == 0 : decades < 2 && (digit == 2 || digit == 5) && e >= -3;
      ticks.push_back({at, named ? log_label(at, e) : ""});
    }
  return ticks;
}

}  // namespace farhand
