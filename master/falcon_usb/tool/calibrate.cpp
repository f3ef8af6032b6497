#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "common/realtime.hpp"
#include "master/falcon_usb/calibration.hpp"
#include "master/falcon_usb/tool/commands.hpp"
#include "master/falcon_usb/tool/hold.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Table {
  const char* name;  // as a scene says it
  FalconGeometry geometry;
};
const Table kTables[] = {{"TABLE1", kFalconTable1},
                         {"TABLE1_S0", kFalconTable1S0},
                         {"TABLE1_FLIP", kFalconTable1Flip},
                         {"LIBNIFALCON", kFalconLibnifalcon}};

// Numbers of one line, or nothing if it holds anything else.
std::optional<std::vector<double>> numbers(const std::string& line) {
  std::istringstream in(line);
  std::vector<double> out;
  for (double x = 0; in >> x;) out.push_back(x);
  if (!in.eof()) return {};
  return out;
}

Vec3 counts_of(const Sample& sample) {
  const auto& n = sample.answer.encoders;
  return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
}

// Mean encoder counts over half a second; the grip must rest.
std::optional<Vec3> rest(Session& session) {
  constexpr int kLook = 500;          // samples
  constexpr double kMostSpread = 20;  // [counts]
  Vec3 sum = Vec3::Zero(), least = Vec3::Constant(1e9), most = -least;
  int samples = 0;
  session.run_samples(kLook, [&](TimePoint, const Sample& sample) {
    const Vec3 counts = counts_of(sample);
    sum += counts;
    least = least.cwiseMin(counts);
    most = most.cwiseMax(counts);
    ++samples;
    return false;
  });
  if (samples == 0 || (most - least).maxCoeff() > kMostSpread) return {};
  return Vec3(sum / samples);
}

// Whether the line asks for that.
template <typename Known>
bool take_back(const std::string& line, std::vector<Known>& known) {
  if (line != "back") return false;
  if (!known.empty()) known.pop_back();
  return true;
}

// Added to those there are.
void add_poses(Session& session, std::vector<KnownPose>& out) {
  std::puts(
      "Known poses. Put the grip where you know its place: the corners of a box, holes of a jig.\n"
      "Any origin will do; x is to the right, y up, z towards you. Four at least, eight are good,\n"
      "far apart in all three directions. Hold it still, type x y z in millimetres, and hold on "
      "until the next question. back takes the last one away, nothing at all ends.");
  for (;;) {
    const std::string line = session.ask(fmt::format("pose {}:", out.size() + 1));
    if (take_back(line, out)) continue;
    const auto p = numbers(line);
    if (p && p->empty()) return;
    if (!p || p->size() != 3) {
      std::puts("three numbers are needed, such as 0 50 20");
      continue;
    }
    if (const auto counts = rest(session))
      out.push_back({*counts, 1e-3 * Vec3((*p)[0], (*p)[1], (*p)[2])});
    else
      std::puts("the grip did not rest; once more");
  }
}

// The best of the tables, each shown; nothing if the poses do not tell.
struct Chosen {
  const char* table;
  GeometryFit fit;
};
std::optional<Chosen> choose(const std::vector<KnownPose>& known) {
  std::optional<Chosen> best;
  for (const Table& t : kTables) {
    const GeometryFit fit = fit_geometry(t.geometry, known);
    if (!fit.good) continue;
    fmt::print("{:<12} gear ratio {:.3f} +- {:.3f}, offset {:.2f} +- {:.2f} deg, {:.2f} mm rms\n",
               t.name, fit.geometry.gear_ratio, fit.gear_ratio_sd,
               fit.geometry.angle_offset / kDegree, fit.angle_offset_sd / kDegree, 1e3 * fit.rms);
    if (!best || fit.rms < best->fit.rms) best = {t.name, fit};
  }
  if (!best) return {};
  fmt::print("{} fits best:\n", best->table);
  for (std::size_t i = 0; i < known.size(); ++i)
    fmt::print("  pose {}: {:.2f} mm off\n", i + 1, 1e3 * best->fit.residuals[i]);
  return best;
}

// Asks until they tell.
Chosen find_geometry(Session& session) {
  std::vector<KnownPose> known;
  for (;;) {
    add_poses(session, known);
    if (const auto chosen = choose(known)) return *chosen;
    std::puts("these poses do not tell the geometry: at least four, far apart, in millimetres");
  }
}

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

// Asks until they tell.
GainFit weigh(Session& session, const DriverConfig& config, const FalconGeometry& geometry) {
  std::puts(
      "Known weights. The motors hold the grip at the centre while a weight hangs on it by a "
      "thread.\nFirst let them: hold the centre and the forward button together for half a second, "
      "then let go.");
  session.reach(Phase::armed, kHands);
  std::puts(
      "Hang a weight on the grip and hold it near the middle of its reach. Type the mass in grams, "
      "0 "
      "for\nnone, at most 300, then let go: the motors hold it for 10 s. Take it again before they "
      "let go. Three\ndifferent ones are good; back takes the last one away, nothing at all ends.");
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

// As a scene's text wants it between quotes.
std::string quoted(const std::string& name) {
  std::string out;
  for (const char c : name) out += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  return out;
}

std::string lines(const CalibrateOptions& options, const Chosen& chosen,
                  const std::optional<GainFit>& gain) {
  std::string out = fmt::format(
      "# Into master {{ }} of a scene.\nfalcon {{\n  geometry: {}\n  gear_ratio: {:.4f}\n  "
      "angle_offset_deg: {:.3f}\n}}\nfalcon_usb {{\n  calibration: \"{}\"\n",
      chosen.table, chosen.fit.geometry.gear_ratio, chosen.fit.geometry.angle_offset / kDegree,
      quoted(options.name));
  if (gain)
    out +=
        fmt::format("  counts_per_newton_meter: {:.0f}\n", std::abs(gain->counts_per_newton_meter));
  return out + "}\n";
}

}  // namespace

int calibrate(Session& session, const DriverConfig& config, const CalibrateOptions& options) {
  session.reach(Phase::homed, kHands);
  const Chosen chosen = find_geometry(session);
  std::optional<GainFit> gain;
  if (options.weights) gain = weigh(session, config, chosen.fit.geometry);
  const std::string text = lines(options, chosen, gain);
  if (!options.file) {
    std::fputs(text.c_str(), stdout);
    return 0;
  }
  std::ofstream out(*options.file);
  if (!(out << text).flush()) {
    std::fputs(text.c_str(), stdout);
    throw std::runtime_error("cannot write " + *options.file + "; its lines are the above");
  }
  std::printf("wrote %s; put its lines into the scene's master\n", options.file->c_str());
  return 0;
}

}  // namespace farhand::falcon_usb
