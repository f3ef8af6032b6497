// Where an axis gets its ticks and what they are called.
#pragma once

#include <string>
#include <vector>

namespace farhand {

struct Tick {
  double at = 0;
  std::string label;  // empty: a mark without a name
};

// Multiples of 1, 2 or 5 times a power of ten within [lo, hi], at most `most` of them, as many as
// that allows. None if the range is empty or not finite. All labels have the same decimals.
std::vector<Tick> linear_ticks(double lo, double hi, int most);

// For a logarithmic axis, 0 < lo < hi: a tick at each of 1 to 9 times a power of ten; labelled are
// the powers (each second, third... if more than `most`), and in less than two decades 2 and 5 too.
std::vector<Tick> log_ticks(double lo, double hi, int most);

}  // namespace farhand
