#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/loop/stability/simulated.hpp"
#include "tests/loop/stability/study.hpp"

namespace farhand {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kPolesShown = 6;

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

std::string number_or(double value, const char* format_if_finite, const char* otherwise) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format_if_finite), value) : otherwise;
}

// A conjugate pair is one row, and so are poles that are alike (a servo's six integrals).
std::string pole_rows(const AxisStudy& s) {
  constexpr double kAlike = 1e-4;
  std::string out = "  poles, the slowest to die first\n";
  std::vector<std::complex<double>> shown;
  for (const Pole& p : s.poles) {
    const auto alike = [&](const std::complex<double>& z) { return std::abs(z - p.z) < kAlike; };
    if (p.z.imag() < 0 || std::any_of(shown.begin(), shown.end(), alike)) continue;
    if (shown.size() == kPolesShown) break;
    shown.push_back(p.z);
    out +=
        fmt::format("    |z| {:.6f}   {:9.3f} Hz   damping {:7.3f}   {:+9.2f} 1/s\n", std::abs(p.z),
                    p.frequency_hz, p.damping_ratio, std::log(std::abs(p.z)) / s.model.Ts);
  }
  return out;
}

std::string margin_rows(const AxisStudy& s) {
  if (!s.stable()) return "  no margins: it is beyond its boundary\n";
  const Margins& m = s.margins;
  std::string out;
  if (std::isfinite(m.gain))
    out += fmt::format("  gain margin    {:6.2f} dB at {:.2f} Hz\n", 20 * std::log10(m.gain),
                       m.gain_at_hz);
  else
    out += "  gain margin    unlimited\n";
  if (std::isfinite(m.phase))
    out += fmt::format("  phase margin   {:6.1f} deg at {:.2f} Hz, {:.2f} ms of further delay\n",
                       degrees(m.phase), m.phase_at_hz, m.delay * 1e3);
  else
    out += "  phase margin   the loop's gain is below 1 at every frequency\n";
  if (s.model.force)
    out += fmt::format("  small-gain bound (kp + 2 kd/Ts) m_u/(m_d + m_u) = {:.3f}, {}\n",
                       s.small_gain,
                       s.small_gain < 1 ? "holds"
                                        : "does not hold (sufficient, "
                                          "without the force filter)");
  return out;
}

std::string limit_rows(const AxisStudy& s) {
  std::string out = "                          scene     predicted     simulated    difference\n";
  for (const ParameterLimit& l : s.limits) {
    const ParameterText words = text(l.parameter);
    const std::string name =
        std::string(words.name) + (words.unit[0] != '\0' ? ", " : "") + words.unit;
    out += fmt::format("  {:<18} {:>10.4g}", name, l.value * words.per_unit);
    if (l.predicted.value == 0)
      out += "   none stable";
    else
      out += fmt::format(" {:>13}", number_or(l.predicted.value * words.per_unit, "{:.4g}", "any"));
    if (l.simulated && *l.simulated > 0)
      out += fmt::format(" {:>13.4g} {:>+11.2f} %", *l.simulated * words.per_unit,
                         100 * (*l.simulated / l.predicted.value - 1));
    out += '\n';
  }
  return out;
}

std::string chatter(double from, double linear) {
  if (from == 0) return fmt::format("at every stiffness down to {:.0f} N/m", linear / 10);
  if (!std::isfinite(from)) return fmt::format("at no stiffness up to {:.0f} N/m", 10 * linear);
  return fmt::format("from {:.4g} N/m on, {:+.0f} % from the linear boundary", from,
                     100 * (from / linear - 1));
}

Json json(const StabilityLimit& l) {
  if (!std::isfinite(l.value)) return "any";
  return l.value;
}

Json json(const AxisStudy& s) {
  Json out = {{"surface", s.surface},
              {"axis_in_slave", {s.model.axis_S.x(), s.model.axis_S.y(), s.model.axis_S.z()}},
              {"stable", s.stable()},
              {"spectral_radius", s.radius}};
  for (const Pole& p : s.poles)
    if (p.z.imag() >= 0) out["poles"].push_back({{"real", p.z.real()}, {"imaginary", p.z.imag()}});
  const auto put = [&](const char* name, double value) {
    if (std::isfinite(value)) out[name] = value;
  };
  put("gain_margin", s.margins.gain);
  put("gain_margin_at_hz", s.margins.gain_at_hz);
  put("phase_margin_deg", degrees(s.margins.phase));
  put("phase_margin_at_hz", s.margins.phase_at_hz);
  put("delay_margin_s", s.margins.delay);
  out["small_gain"] = s.small_gain;
  for (const ParameterLimit& l : s.limits) {
    Json row = {{"parameter", text(l.parameter).name},
                {"scene", l.value},
                {"predicted", json(l.predicted)}};
    if (l.simulated) row["simulated"] = *l.simulated;
    out["limits"].push_back(row);
  }
  out["felt_newton_per_m"] = {
      {"wall", s.felt.wall}, {"servo", s.felt.servo}, {"predicted", s.felt.felt}};
  if (s.felt_measured) out["felt_newton_per_m"]["measured"] = *s.felt_measured;
  if (s.chatter_stiffness) {
    out["chatters_from_newton_per_m"] = {{"pressed", json(StabilityLimit{*s.chatter_stiffness})},
                                         {"knocked", json(StabilityLimit{*s.knocked_stiffness})}};
  }
  return out;
}

}  // namespace

std::string to_text(const Scene& scene, const AxisStudy& s) {
  const Vec3 a = s.model.axis_S + Vec3::Zero();  // no minus before a zero
  std::string out = fmt::format("{}: surface[{}], pressed along ({:.3g}, {:.3g}, {:.3g}) of S\n",
                                scene.path, s.surface, a.x(), a.y(), a.z());
  out +=
      fmt::format("  {}, spectral radius {:.6f}\n", s.stable() ? "stable" : "UNSTABLE", s.radius);
  out += pole_rows(s);
  if (s.model.reflects) out += margin_rows(s);
  out += "  boundaries of the linear loop\n" + limit_rows(s);
  if (s.chatter_stiffness)
    out += fmt::format(
        "  with friction and limits, pressing with {:g} N on a one-sided wall: chatters {};\n"
        "  the same after a knock of {:g} N: {}\n",
        kPress, chatter(*s.chatter_stiffness, *s.limits[0].simulated), kKnock,
        chatter(*s.knocked_stiffness, *s.limits[0].simulated));
  out += fmt::format("  felt stiffness {:.1f} N/m of wall {:.1f} and servo {:.1f} N/m in series",
                     s.felt.felt, s.felt.wall, s.felt.servo);
  if (s.felt_measured)
    out += fmt::format("; measured {:.1f} ({:+.3f} %)", *s.felt_measured,
                       100 * (*s.felt_measured / s.felt.felt - 1));
  return out + "\n";
}

std::string to_json(const Scene& scene, const std::vector<AxisStudy>& studies) {
  Json out = {{"scene", scene.path}, {"axes", Json::array()}};
  for (const AxisStudy& s : studies) out["axes"].push_back(json(s));
  return out.dump(2) + "\n";
}

}  // namespace farhand
