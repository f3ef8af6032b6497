#include "tests/sim/plan.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace farhand {
namespace {

// Times [s] and sizes are drawn so that each decade is as likely as the next.
struct FaultRange {
  const char* name;
  const char* size;  // what it is
  double shortest, longest;
  double least, most;
};

constexpr std::array<FaultRange, kFaultKinds> kRanges = {{
    {"delay", "ms more", 0.1, 5, 1, 200},
    {"jitter", "ms, mean", 0.1, 5, 0.1, 20},
    {"spikes", "ms", 0.5, 5, 10, 150},
    {"losses", "of all", 0.1, 5, 0.001, 0.5},
    {"bursts", "of all begin one", 0.5, 5, 0.001, 0.02},
    {"blackout", "", 0.005, 4, 1, 1},
    {"duplicates", "of all", 0.1, 5, 0.01, 0.5},
    {"reordering", "of all", 0.1, 5, 0.01, 0.3},
    {"corruption", "of all", 0.1, 5, 0.001, 0.2},
    {"rate cap", "kbit/s", 0.2, 4, 50, 4000},
    {"master stall", "", 0.001, 2, 1, 1},
    {"slave stall", "", 0.001, 2, 1, 1},
    {"master restart", "", 0.01, 2, 1, 1},
    {"slave restart", "", 0.01, 2, 1, 1},
    {"master clock step", "s forward", 0.001, 0.001, 1e-5, 10},
    {"slave clock step", "s forward", 0.001, 0.001, 1e-5, 10},
    {"device loss", "", 0.001, 2, 1, 1},
    {"device spoilt", "of all samples", 0.002, 2, 0.01, 1},
    {"robot loss", "", 0.001, 2, 1, 1},
    {"robot spoilt", "of all samples", 0.002, 2, 0.01, 0.9},
    {"second master", "", 0.05, 3, 1, 1},
    {"replay", "datagrams a ms", 0.1, 3, 0.05, 3},
    {"forgery", "datagrams a ms", 0.1, 3, 0.05, 3},
}};

const FaultRange& range(FaultKind kind) {
  return kRanges[static_cast<std::size_t>(kind)];
}

double draw(Random& random, double least, double most) {
  return least * std::pow(most / least, random.uniform());
}

template <typename T, std::size_t n>
const T& pick(Random& random, const std::array<T, n>& of) {
  return of[random.bits() % n];
}

ClockError draw_clock(Random& random) {
  return {.ahead = from_seconds(1e4 * random.uniform()),
          .ppb = static_cast<std::int64_t>(1e5 * (2 * random.uniform() - 1))};
}

Fault draw_fault(Random& random, const Plan& plan) {
  Fault f;
  do f.kind = static_cast<FaultKind>(random.bits() % kFaultKinds);
  while (plan.secure && f.kind == FaultKind::second_master);
  const FaultRange& r = range(f.kind);
  const double room = seconds(plan.quiet - Plan::kOrder);
  const double lasting = std::min(draw(random, r.shortest, r.longest), room);
  f.at = Plan::kOrder + from_seconds((room - lasting) * random.uniform());
  f.until = f.at + from_seconds(lasting);
  f.size = draw(random, r.least, r.most);
  f.ways = static_cast<std::uint8_t>(1 + random.bits() % 3);
  f.seed = random.bits();
  return f;
}

// What there is to choose within a scene. From a stream of its own: the faults of a seed stay.
void draw_variant(Plan& plan) {
  constexpr std::array<const char*, 3> kFar = {"damped", "mmt", "auto"};
  constexpr std::array<const char*, 4> kAnywhere = {"direct", "wave", "smith", "auto"};
  constexpr std::array<double, 3> kWays = {1, 10, 45};
  constexpr std::array<double, 2> kKeepAlive = {5, 50};
  Random random(plan.seed ^ 0x76617279);
  const bool far = plan.scene == "twin_delta_far", closed = plan.scene == "twin_delta_closed";
  if (far) plan.method = kFar[plan.seed % kFar.size()];
  if (far && random.uniform() < 0.6) {
    plan.method = pick(random, kAnywhere);
    plan.one_way_ms = pick(random, kWays);
  }
  if (closed && random.uniform() < 0.4) plan.method = "direct";
  const bool reflects = closed || plan.scene == "falcon_closed" || plan.method == "direct";
  if (reflects && random.uniform() < 0.4) plan.keep_alive_ms = pick(random, kKeepAlive);
  const bool turns = far || closed || plan.scene == "minimal";
  if (turns && random.uniform() < 0.35) plan.alignment_deg = draw(random, 3, 30);
}

void add(ImpairmentConfig& c, const Fault& f) {
  switch (f.kind) {
    case FaultKind::delay:
      c.delay_ms += f.size;
      break;
    case FaultKind::jitter:
      c.jitter_ms += f.size;
      break;
    case FaultKind::spikes:
      c.spike_ms = f.size;
      c.spike_pause_s = 0.3;
      break;
    case FaultKind::losses:
      c.loss_ratio = std::max(c.loss_ratio, f.size);
      break;
    case FaultKind::bursts:
      c.burst_enter_ratio = f.size;
      c.burst_leave_ratio = 0.05;
      break;
    case FaultKind::blackout:
      c.loss_ratio = 1;
      break;
    case FaultKind::duplicates:
      c.duplicate_ratio = f.size;
      break;
    case FaultKind::reordering:
      c.reorder_ratio = f.size;
      break;
    case FaultKind::corruption:
      c.corrupt_ratio = f.size;
      break;
    case FaultKind::rate_cap:
      c.cap_kbit_per_s = f.size;
      break;
    default:
      break;
  }
}

}  // namespace

bool of_network(FaultKind kind) {
  return kind <= FaultKind::rate_cap;
}

Plan draw_plan(std::uint64_t seed, Duration length) {
  constexpr std::array<const char*, 5> kScenes = {"minimal", "twin_delta_closed", "twin_delta_far",
                                                  "falcon_closed", "twin_delta_guided"};
  Random random(seed);
  Plan plan{.seed = seed,
            .scene = pick(random, kScenes),
            .quiet = length - Plan::kQuiet,
            .end = length,
            .master_clock = draw_clock(random),
            .slave_clock = draw_clock(random),
            .secure = random.uniform() < 0.7};
  const auto faults = 1 + random.bits() % 12;
  for (std::uint64_t i = 0; i < faults; ++i) plan.faults.push_back(draw_fault(random, plan));
  std::stable_sort(plan.faults.begin(), plan.faults.end(),
                   [](const Fault& a, const Fault& b) { return a.at < b.at; });
  draw_variant(plan);
  return plan;
}

ImpairmentConfig network_at(const Plan& plan, Way way, const ImpairmentConfig& scene, Duration t) {
  ImpairmentConfig c = scene;
  for (const Fault& f : plan.faults)
    if (of_network(f.kind) && (f.ways & way) != 0 && f.at <= t && t < f.until) add(c, f);
  return c;
}

std::string to_string(const Fault& f) {
  const FaultRange& r = range(f.kind);
  std::string out =
      fmt::format("{:7.3f} to {:7.3f} s  {}", seconds(f.at), seconds(f.until), r.name);
  if (*r.size != '\0') out += fmt::format(", {:.4g} {}", f.size, r.size);
  if (of_network(f.kind) && f.ways != (kToSlave | kToMaster))
    out += f.ways == kToSlave ? ", to the slave only" : ", to the master only";
  return out;
}

std::string variant(const Plan& p) {
  std::string out = p.scene;
  if (!p.method.empty()) out += " " + p.method;
  if (p.one_way_ms) out += fmt::format(", {:g} ms each way", *p.one_way_ms);
  if (p.keep_alive_ms) out += fmt::format(", answers every {:g} ms", *p.keep_alive_ms);
  if (p.alignment_deg) out += fmt::format(", aligned to {:.1f} deg", *p.alignment_deg);
  return out;
}

std::string to_string(const Plan& p) {
  std::string out = fmt::format(
      "seed {}: {}, {} channel, clocks {:+.1f} and {:+.1f} ppm, {:g} s, quiet from {:g} s\n",
      p.seed, variant(p), p.secure ? "secure" : "plain",
      static_cast<double>(p.master_clock.ppb) / 1e3, static_cast<double>(p.slave_clock.ppb) / 1e3,
      seconds(p.end), seconds(p.quiet));
  for (const Fault& f : p.faults) out += "  " + to_string(f) + "\n";
  return out;
}

}  // namespace farhand
