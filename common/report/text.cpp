#include "common/report/text.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

constexpr std::string_view kMinus = "\u2212";
constexpr std::string_view kNoValue = "\u2013";

std::string with_minus(std::string digits) {
  if (digits.empty() || digits.front() != '-') return digits;
  const bool zero = digits.find_first_of("123456789") == std::string::npos;
  return (zero ? std::string() : std::string(kMinus)) + digits.substr(1);
}

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string fixed(double x, int decimals) {
  if (!std::isfinite(x)) return std::string(kNoValue);
  return with_minus(fmt::format("{:.{}f}", x, std::max(decimals, 0)));
}

int decimals_for(double x) {
  if (!std::isfinite(x) || x == 0) return 0;
  // Rounding first: 9.996 has as many digits before the point as 10.
  const double rounded = std::stod(fmt::format("{:.2e}", std::abs(x)));
  return std::max(0, 2 - static_cast<int>(std::floor(std::log10(rounded))));
}

std::string figure(double x) {
  const bool tiny = std::isfinite(x) && x != 0 && std::abs(x) < 1e-3;
  return tiny ? with_minus(fmt::format("{:.2e}", x)) : fixed(x, decimals_for(x));
}

double text_width(std::string_view text, double size) {
  double em = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0u) == 0x80u) continue;  // the rest of a code point
    if (std::string_view(" .,:;'|!ijlftI()[]").find(c) != std::string_view::npos)
      em += 0.36;
    else
      em += std::string_view("mwMW@%").find(c) != std::string_view::npos ? 0.92 : 0.6;
  }
  return em * size;
}

}  // namespace farhand
