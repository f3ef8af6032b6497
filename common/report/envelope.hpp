// Thinning of a long signal to what a chart can show, without losing a peak.
#pragma once

#include <span>
#include <vector>

namespace farhand {

struct Point {
  double x = 0;
  double y = 0;  // NaN: the line is interrupted here
};

// y over t in at most `columns` columns of [lo, hi], of each the first smallest and the first
// largest sample, in the order of time. So every sample lies within the drawn band, and the largest
// and smallest of all survive as they are. Up to two samples per column nothing is left out. t
// ascends and is as long as y; samples outside [lo, hi] are left out. A column without a finite
// sample interrupts the line. Values are multiplied by `scale`.
std::vector<Point> envelope(std::span<const double> t, std::span<const float> y, double lo,
                            double hi, int columns, double scale = 1);

// The path y over x (a curve in the plane, not a function of x) without samples nearer than
// `spacing` to the last one kept, in either direction; the extremes of x and y survive. Samples
// where either is not finite interrupt the line.
std::vector<Point> thin_path(std::span<const float> x, std::span<const float> y, double spacing,
                             double scale = 1);

}  // namespace farhand
