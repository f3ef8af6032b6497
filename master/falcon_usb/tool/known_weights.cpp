#include "master/falcon_usb/tool/known_weights.hpp"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <stdexcept>

#include "common/realtime.hpp"
#include "master/falcon_usb/counts.hpp"
#include "master/falcon_usb/tool/answers.hpp"
#include "master/falcon_usb/tool/hold.hpp"

namespace farhand::falcon_usb {
namespace {

// What holds the grip at the centre against a weight, in motor counts; nothing if it was not at
// rest there.
std::optional<KnownLoad> carried(Session& session, const DriverConfig& config,
                                 const FalconGeometry& geometry, double mass) {
  constexpr int kSettle = 8000, kLook = 2000;  // samples
  constexpr double kAtRest = 0.001;            // [m]
  const Vec3 centre(0, 0, 0.115);
  Hold hold(geometry);
  hold.go(centre);
  KnownLoad out{.mass = mass};
  int samples = -kSettle;
  std::optional<Hold::Step> step;
  session.run_samples(kSettle + kLook, [&](TimePoint now, const Sample& sample) {
    HandleReading reading = session.driver().read(now);
    // The driver has the geometry that was known before.
    reading.theta.head<3>() = theta1_from_counts(geometry, counts_of(sample).cast<int>());
    step = hold.step(now, reading);
    session.driver().write(now, step ? step->tau : Vec6(Vec6::Zero()));
    if (!session.armed() || !step || step->lost) return true;
    if (samples++ < 0) return false;
    out.p_MH += step->p_MH;
    out.motors += config.counts_per_newton_meter * step->tau.head<3>();
    return false;
  });
  session.driver().write(monotonic_now(), Vec6::Zero());
  if (!session.armed() || samples < kLook) return {};
  out.p_MH /= samples;
  out.motors /= samples;
  const bool there = (out.p_MH - centre).norm() < Hold::kLost;
  return there && (step->p_MH - out.p_MH).norm() < kAtRest ? std::optional(out) : std::nullopt;
}

// Added to those there are.
void add_loads(Session& session, const DriverConfig& config, const FalconGeometry& geometry,
               std::vector<KnownLoad>& loads) {
  for (;;) {
    const std::string line = session.ask(fmt::format("weight {}:", loads.size() + 1));
    if (take_back(line, loads)) continue;
    const auto grams = numbers(line);
    if (grams && grams->empty()) return;
    if (!grams || grams->size() != 1 || grams->front() < 0 || grams->front() > 300) {
      std::puts("one number from 0 to 300 is needed");
      continue;
    }
    session.reach(Phase::armed, kHands);
    std::puts("the motors hold it for 10 s: let go of it");
    if (const auto load = carried(session, config, geometry, 1e-3 * grams->front()))
      loads.push_back(*load);
    else
      std::puts(
          "the grip was not held, or did not rest; once more, and if that does not help, hang a "
          "lighter weight");
  }
}

}  // namespace

GainFit weigh(Session& session, const DriverConfig& config, const FalconGeometry& geometry) {
  std::puts(
      "Known weights. The motors hold the grip at the centre while a weight hangs on it by a "
      "thread.\n"
      "First let them: hold the centre and the forward button together for half a second, then "
      "let\n"
      "go.");
  session.reach(Phase::armed, kHands);
  std::puts(
      "Hang a weight on the grip and hold it near the middle of its reach. Type the mass in "
      "grams,\n"
      "0 for none, at most 300, then let go: the motors hold it for 10 s. Take it again before "
      "they\n"
      "let go. Three different ones are good; back takes the last one away, nothing at all ends.");
  std::vector<KnownLoad> loads;
  GainFit fit;
  for (;;) {
    add_loads(session, config, geometry, loads);
    fit = fit_gain(geometry, loads);
    if (fit.good) break;
    std::puts("these weights do not tell: at least two that differ by 20 g or more");
  }
  fmt::print("counts per N m {:.0f} +- {:.0f}, the grip itself {:.0f} g\n",
             std::abs(fit.counts_per_newton_meter), fit.gain_sd, 1e3 * fit.grip_mass);
  for (std::size_t i = 0; i < loads.size(); ++i)
    fmt::print("  weight {}: {:.3f} N off\n", i + 1, fit.residuals[i]);
  if (fit.counts_per_newton_meter > 0)
    throw std::runtime_error("the motors push the wrong way: no numbers are written");
  return fit;
}

}  // namespace farhand::falcon_usb
