// Figures of a force that repeats with the hand's motion: what repeats, and what does not.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace farhand {

inline constexpr double kTurn = 2 * std::numbers::pi;

struct Swing {
  double mean = 0;       // [N] of F_u
  double peak = 0;       // [N] largest |F_u|
  double half = 0;       // [N] half of the swing of the mean period
  double per_mm = 0;     // [N/mm] of the handle's own swing
  double component = 0;  // [N/mm] at the motion's frequency
  double felt = 0;       // [N rms] of F_u, what is not periodic
  double noise = 0;      // [N rms] of the measured force, likewise
};

class Periodic {
 public:
  Periodic(long ticks, int periods)
      : periods_(periods), F_(size(ticks)), x_(F_), F2_(F_), M_(F_), M2_(F_) {}

  bool complete() const { return seen_ == F_.size() * size(periods_); }

  // F_u true and measured, and the handle's place [m].
  void add(double F_u, double x, double F_measured) {
    const std::size_t i = seen_++ % F_.size();
    F_[i] += F_u / periods_, F2_[i] += F_u * F_u / periods_, x_[i] += x / periods_;
    M_[i] += F_measured / periods_, M2_[i] += F_measured * F_measured / periods_;
    peak_ = std::max(peak_, std::abs(F_u));
  }

  Swing swing() const {
    Swing out{.peak = peak_, .half = half(F_), .felt = spread(F_, F2_), .noise = spread(M_, M2_)};
    double c = 0, s = 0;
    const auto n = static_cast<double>(F_.size());
    for (std::size_t i = 0; i < F_.size(); ++i) {
      const double angle = kTurn * static_cast<double>(i) / n;
      out.mean += F_[i] / n;
      c += F_[i] * std::cos(angle) * 2 / n;
      s += F_[i] * std::sin(angle) * 2 / n;
    }
    out.per_mm = out.half / (half(x_) * 1e3);
    out.component = std::hypot(c, s) / (half(x_) * 1e3);
    return out;
  }

 private:
  static std::size_t size(long n) { return static_cast<std::size_t>(n); }
  static double half(const std::vector<double>& v) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    return (*high - *low) / 2;
  }
  // About the mean period.
  double spread(const std::vector<double>& mean, const std::vector<double>& square) const {
    double sum = 0;
    for (std::size_t i = 0; i < mean.size(); ++i)
      sum += std::max(0.0, square[i] - mean[i] * mean[i]) / static_cast<double>(mean.size());
    return std::sqrt(sum * (periods_ > 1 ? periods_ / (periods_ - 1.0) : 1));
  }

  int periods_;
  std::size_t seen_ = 0;
  double peak_ = 0;
  std::vector<double> F_, x_, F2_, M_, M2_;
};

}  // namespace farhand
