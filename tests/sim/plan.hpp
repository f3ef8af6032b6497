// What an episode of the fault simulation is made of, all drawn from its seed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/impairment.hpp"
#include "common/random.hpp"
#include "common/time.hpp"
#include "tests/loop/side_clock.hpp"

namespace farhand {

enum class FaultKind : std::uint8_t {
  // of the network, one way or both
  delay,
  jitter,
  spikes,
  losses,
  bursts,
  blackout,
  duplicates,
  reordering,
  corruption,
  rate_cap,
  // of a side
  master_stall,
  slave_stall,
  master_restart,
  slave_restart,
  master_clock,
  slave_clock,
  device_loss,
  device_spoilt,
  robot_loss,
  robot_spoilt,
  // by others
  second_master,
  replay,
  forgery,
};
inline constexpr std::size_t kFaultKinds = 23;

enum Way : std::uint8_t { kToSlave = 1, kToMaster = 2 };

// What `size` means is in the table of plan.cpp.
struct Fault {
  FaultKind kind = FaultKind::delay;
  Duration at{}, until{};  // since the episode's begin
  double size = 0;
  std::uint8_t ways = kToSlave | kToMaster;
  std::uint64_t seed = 0;
};

// Faults begin after kOrder and end before `quiet`; from then on everything must come back.
struct Plan {
  static constexpr Duration kOrder = std::chrono::seconds(1);
  static constexpr Duration kQuiet = std::chrono::seconds(9);

  std::uint64_t seed = 0;
  std::string scene;
  Duration quiet{}, end{};
  ClockError master_clock, slave_clock;
  bool secure = true;  // the stand-in for DTLS is on
  std::string method;  // of the compensation, as a scene names it; empty: as the scene has it
  std::optional<double> one_way_ms;     // of the network, instead of the scene's
  std::optional<double> keep_alive_ms;  // of the answers' deadband
  std::optional<double> alignment_deg;
  std::vector<Fault> faults;
};

// length: above kOrder + kQuiet.
Plan draw_plan(std::uint64_t seed, Duration length);

// The scene's network at `t` under all faults that are on.
ImpairmentConfig network_at(const Plan& plan, Way way, const ImpairmentConfig& scene, Duration t);
bool of_network(FaultKind kind);

std::string to_string(const Fault& fault);
std::string variant(const Plan& plan);    // the scene, and what was chosen within it
std::string to_string(const Plan& plan);  // several lines

}  // namespace farhand
