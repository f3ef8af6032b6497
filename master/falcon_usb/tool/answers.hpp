// What the calibration's questions have in common.
#pragma once

#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "master/falcon_usb/exchange.hpp"

namespace farhand::falcon_usb {

inline constexpr double kDegree = std::numbers::pi / 180;

// Numbers of one line, or nothing if it holds anything else.
inline std::optional<std::vector<double>> numbers(const std::string& line) {
  std::istringstream in(line);
  std::vector<double> out;
  for (double x = 0; in >> x;) out.push_back(x);
  if (!in.eof()) return {};
  return out;
}

// Whether the line asks for the last one to be taken away, which it then is.
template <typename Known>
bool take_back(const std::string& line, std::vector<Known>& known) {
  if (line != "back") return false;
  if (!known.empty()) known.pop_back();
  return true;
}

inline Vec3 counts_of(const Sample& sample) {
  const auto& n = sample.answer.encoders;
  return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
}

}  // namespace farhand::falcon_usb
