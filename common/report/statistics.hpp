// Statistics of columns: size of an error, and times.
#pragma once

#include <functional>
#include <vector>

#include "common/report/run_data.hpp"

namespace farhand {

// rms, 99 % quantile and largest of |x|, NaN left out; empty without a finite sample.
std::vector<double> error_figures(std::vector<float> samples);

// Median, 99 % quantile (both to 2.2 %, common/histogram.hpp) and largest [s] of times in us.
std::vector<double> time_figures(const Column& microseconds);

// Mean change from one round trip to the next [s], of those that differ: a value stays until the
// next exchange. NaN if there were none.
double jitter(const Column& round_trip_us);

// |a - b|, NaN where a component is missing.
Column distance(const Columns<3>& a, const Columns<3>& b);
Column length(const Columns<3>& a);

// Whether there is a value at all.
bool recorded(const Columns<3>& a) noexcept;

// The samples for which `where` holds.
std::vector<float> select(const Column& samples, const std::function<bool(std::size_t)>& where);

// Energy [J] that the two ports together gave out, at the slave's ticks: to the hand plus to the
// environment. Positive at the end of a run: the teleoperation is active.
Column generated_energy(const MasterData& master, const SlaveData& slave);

}  // namespace farhand
