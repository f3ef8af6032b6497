// By how much a whole command may grow before its loop becomes restless, found by simulation.
#pragma once

#include <array>
#include <cmath>

namespace farhand {

// Rms of the command's steps while the handle is held still, moved, and held still without
// friction.
using Unrest = std::array<double, 3>;

// A loop far from its margin is restless in proportion to its gain. Three times that is beyond it.
inline bool calm(const Unrest& now, double gain, const Unrest& at_one) {
  for (std::size_t i = 0; i < now.size(); ++i)
    if (!(now[i] <= 3 * gain * at_one[i])) return false;
  return true;
}

// [dB], up to 24. unrest(gain) runs the loop with the whole command, feed-forward included, times
// gain.
template <typename Run>
double gain_margin_db(Run&& unrest, int halvings = 6) {
  const Unrest at_one = unrest(1.0);
  double low = 0, high = 24;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (low + high) / 2, gain = std::pow(10, middle / 20);
    (calm(unrest(gain), gain, at_one) ? low : high) = middle;
  }
  return low;
}

}  // namespace farhand
