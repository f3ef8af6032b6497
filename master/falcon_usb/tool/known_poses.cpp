#include "master/falcon_usb/tool/known_poses.hpp"

#include <spdlog/fmt/fmt.h>

#include <cstdio>

#include "master/falcon_usb/tool/answers.hpp"

namespace farhand::falcon_usb {
namespace {

struct Table {
  const char* name;  // as a scene says it
  FalconGeometry geometry;
};
const Table kTables[] = {{"TABLE1", kFalconTable1},
                         {"TABLE1_S0", kFalconTable1S0},
                         {"TABLE1_FLIP", kFalconTable1Flip},
                         {"LIBNIFALCON", kFalconLibnifalcon}};

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

}  // namespace

Chosen find_geometry(Session& session) {
  std::vector<KnownPose> known;
  for (;;) {
    add_poses(session, known);
    if (const auto chosen = choose(known)) return *chosen;
    std::puts("these poses do not tell the geometry: at least four, far apart, in millimetres");
  }
}

}  // namespace farhand::falcon_usb
