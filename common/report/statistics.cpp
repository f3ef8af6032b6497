#include "common/report/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "common/histogram.hpp"
#include "common/statistics.hpp"

namespace farhand {
namespace {

constexpr double kHigh = 0.99;

}  // namespace

std::vector<double> error_figures(std::vector<float> samples) {
  std::erase_if(samples, [](float x) { return !std::isfinite(x); });
  if (samples.empty()) return {};
  Rms rms;
  for (float& x : samples) {
    rms.add(x);
    x = std::abs(x);
  }
  const auto rank =
      static_cast<std::size_t>(std::ceil(kHigh * static_cast<double>(samples.size()))) - 1;
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(samples.begin(), nth, samples.end());
  return {rms.value(), *nth, rms.peak};
}

std::vector<double> time_figures(const Column& microseconds) {
  Histogram h;
  for (const float us : microseconds)
    if (std::isfinite(us)) h.add(from_seconds(us * 1e-6));
  if (h.count() == 0) return {};
  return {seconds(h.quantile(0.5)), seconds(h.quantile(kHigh)), seconds(h.max())};
}

double jitter(const Column& round_trip_us) {
  double sum = 0, last = std::numeric_limits<double>::quiet_NaN();
  std::size_t changes = 0;
  for (const float us : round_trip_us) {
    if (!std::isfinite(us)) continue;
    if (const double change = std::abs(us - last); change > 0) sum += change, ++changes;
    last = us;
  }
  if (std::isnan(last)) return last;
  return changes > 0 ? sum * 1e-6 / static_cast<double>(changes) : 0;
}

Column distance(const Columns<3>& a, const Columns<3>& b) {
  Column out(a[0].size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::sqrt((a[0][i] - b[0][i]) * (a[0][i] - b[0][i]) +
                       (a[1][i] - b[1][i]) * (a[1][i] - b[1][i]) +
                       (a[2][i] - b[2][i]) * (a[2][i] - b[2][i]));
  return out;
}

bool recorded(const Columns<3>& a) noexcept {
  return std::any_of(a[0].begin(), a[0].end(), [](float x) { return std::isfinite(x); });
}

Column length(const Columns<3>& a) {
  Column out(a[0].size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::sqrt(a[0][i] * a[0][i] + a[1][i] * a[1][i] + a[2][i] * a[2][i]);
  return out;
}

std::vector<float> select(const Column& samples, const std::function<bool(std::size_t)>& where) {
  std::vector<float> out;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (where(i)) out.push_back(samples[i]);
  return out;
}

Column generated_energy(const MasterData& master, const SlaveData& slave) {
  Column out(slave.size());
  std::size_t m = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    while (m + 1 < master.size() && master.t[m + 1] <= slave.t[i]) ++m;
    const bool begun = m < master.size() && master.t[m] <= slave.t[i];
    out[i] = slave.work[i] + (begun ? master.work[m] : 0.0f);
  }
  return out;
}

}  // namespace farhand
