#include "tests/loop/stability/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/loop/loopback.hpp"

namespace farhand {
namespace {

constexpr double kLook = 0.05;    // [s] between two looks at a run
constexpr double kFound = 0.005;  // of the boundary
constexpr double kChatterFound = 0.05;
constexpr double kFarthest = 10;  // from the guess

Vec3 hand_velocity(const AnyDevice& device) {
  return std::visit(
      [](const auto& d) -> Vec3 {
        if constexpr (requires { d.truth(); })
          return d.truth().state.v_MH;
        else
          return Vec3::Zero();
      },
      device);
}

// Peak speed of handle or tool, every hundredth of a second.
class Envelope {
 public:
  explicit Envelope(double from) : from_(from) {}

  void add(double t, double speed) {
    if (t < from_) return;
    const auto at = static_cast<std::size_t>((t - from_) / kGrain);
    if (at >= peaks_.size()) peaks_.resize(at + 1, 0);
    peaks_[at] = std::max(peaks_[at], speed);
  }

  // Nothing more can be learnt.
  bool certain() const {
    const double last = peak(peaks_.size() - std::min(peaks_.size(), kTail), peaks_.size());
    return last > kLoud || last < kVanished * peak(0, peaks_.size());
  }

  // Least squares through the logarithms of the peaks in the later five of eight equal spans.
  double slope() const {
    constexpr std::size_t kSpans = 8, kFirst = 3;
    const std::size_t each = peaks_.size() / kSpans;
    if (each == 0) return peaks_.empty() ? 0 : kAtOnce;
    double rise = 0, spread = 0;
    for (std::size_t i = kFirst; i < kSpans; ++i) {
      const double from_middle = static_cast<double>(i) - (kFirst + kSpans - 1) / 2.0;
      rise += from_middle * std::log(peak(i * each, (i + 1) * each));
      spread += from_middle * from_middle;
    }
    return rise / spread / (static_cast<double>(each) * kGrain);
  }

 private:
  static constexpr double kGrain = 0.01;     // [s]
  static constexpr std::size_t kTail = 50;   // grains
  static constexpr double kLoud = 0.001;     // [m/s]; the nudge gives some millionths
  static constexpr double kVanished = 1e-6;  // of the loudest
  static constexpr double kAtOnce = 100;     // [1/s], of what is loud within a few grains

  double peak(std::size_t first, std::size_t end) const {
    return *std::max_element(peaks_.begin() + static_cast<std::ptrdiff_t>(first),
                             peaks_.begin() + static_cast<std::ptrdiff_t>(end));
  }

  double from_;
  std::vector<double> peaks_;
};

// Where `grows` turns from false to true, walking outwards from the guess. 0 and infinity: it does,
// or does not, all the way to kFarthest.
double turn(const std::function<bool(double)>& grows, double guess, double first_step,
            double found) {
  double calm = guess / first_step, wild = guess * first_step;
  for (double stride = 1.1; grows(calm); stride *= 1.3) {
    if (guess > kFarthest * calm) return 0;
    wild = calm, calm /= stride;
  }
  for (double stride = 1.1; !grows(wild); stride *= 1.3) {
    if (wild > kFarthest * guess) return std::numeric_limits<double>::infinity();
    calm = wild, wild *= stride;
  }
  while (wild > (1 + found) * calm) {
    const double middle = std::sqrt(calm * wild);
    (grows(middle) ? wild : calm) = middle;
  }
  return std::sqrt(calm * wild);
}

}  // namespace

double growth_rate(const Scene& linear, double longest_s) {
  const proto::Push& nudge = linear.proto.master().sim_hand().push(0);
  const double begin = nudge.at_s() + nudge.lasting_s();
  const AxisModel axis = axis_model(linear, 0);
  Loopback loop(linear, {.duration_s = begin + longest_s});
  Envelope envelope(begin);
  loop.on_master = [&](const MasterTick& t) {
    envelope.add(seconds(t.now - loop.start()),
                 std::abs(axis.axis_M.dot(hand_velocity(loop.device()))));
  };
  loop.on_slave = [&](const SlaveTick& t) {
    envelope.add(seconds(t.now - loop.start()), std::abs(axis.axis_S.dot(t.out.V_SE.linear)));
  };
  for (double t = begin + kLook; t <= begin + longest_s; t += kLook) {
    loop.run_until(loop.start() + from_seconds(t));
    if (envelope.certain()) break;
  }
  return envelope.slope();
}

double simulated_limit(const Scene& scene, int surface, Parameter p, double guess) {
  const auto grows = [&](double value) {
    return growth_rate(linear_scene(with(scene, surface, p, value), surface)) > 0;
  };
  const double limit = turn(grows, guess, 1.04, kFound);
  return std::isfinite(limit) ? limit : 0;
}

bool chatters(const Scene& pressing) {
  constexpr double kChatter = 0.005;  // [m/s] rms
  Loopback loop(pressing, {.duration_s = kJudged + 1});
  double sum = 0;
  int ticks = 0;
  loop.on_master = [&](const MasterTick& t) {
    if (seconds(t.now - loop.start()) < kJudged) return;
    sum += hand_velocity(loop.device()).squaredNorm();
    ++ticks;
  };
  loop.run();
  return sum > kChatter * kChatter * ticks;
}

double chatter_limit(const Scene& scene, int surface, Parameter p, double guess, double knock) {
  const auto grows = [&](double value) {
    return chatters(pressing_scene(with(scene, surface, p, value), surface, knock));
  };
  return turn(grows, guess, 1.5, kChatterFound);
}

}  // namespace farhand
