// Signals of a run over time, for the charts of experiments.
#pragma once

#include <string>
#include <vector>

#include "common/report/chart.hpp"

namespace farhand {

struct Signal {
  std::vector<double> t;
  std::vector<float> y;

  void add(double time, double value) {
    t.push_back(time);
    y.push_back(static_cast<float>(value));
  }
};

inline Line drawn(const Signal& s, std::string name, int style, double from, double to,
                  double scale = 1) {
  constexpr int kColumns = 640;
  return {std::move(name), style, envelope(s.t, s.y, from, to, kColumns, scale)};
}

inline Panel over_time(std::string label, double from, double to, std::vector<Line> lines) {
  return {.x = {.label = "time [s]", .lo = from, .hi = to},
          .y = {.label = std::move(label)},
          .lines = std::move(lines)};
}

}  // namespace farhand
