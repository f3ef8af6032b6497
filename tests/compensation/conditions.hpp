// The networks every method is held against: delays, each with several shapes of jitter, kinds of
// loss and other trouble.
#pragma once

#include <string>
#include <vector>

#include "tests/compensation/bench.hpp"

namespace farhand::bench {

struct Condition {
  std::string name;
  double rtt_ms = 0;
  ImpairmentConfig forward{}, backward{};

  double T1() const { return 1e-3 * forward.delay_ms; }
  Rig rig(double wall, std::uint64_t seed = 1) const {
    Rig s{.forward = forward, .backward = backward, .seed = seed};
    s.wall.k = wall;
    return s;
  }
};

inline constexpr double kRoundTrips[] = {0, 5, 10, 20, 50, 100, 200, 400};
inline constexpr double kWalls[] = {200, 1000, 5000};

// Changes both ways of a condition.
struct Trouble {
  std::string name;
  void (*apply)(Condition&);
};
inline void both(Condition& c, void (*change)(ImpairmentConfig&, double rtt_ms)) {
  change(c.forward, c.rtt_ms), change(c.backward, c.rtt_ms);
}
inline void bursts(Condition& c, double enter) {
  for (ImpairmentConfig* i : {&c.forward, &c.backward})
    i->burst_enter_ratio = enter, i->burst_leave_ratio = 0.2;
}

inline const std::vector<Trouble>& jitters() {
  static const std::vector<Trouble> kAll = {
      {"constant", [](Condition&) {}},
      {"gamma",
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double rtt) { i.jitter_ms = 0.1 * rtt; });
       }},
      {"normal",
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double rtt) {
           i.jitter_ms = 0.05 * rtt, i.jitter_kind = JitterKind::normal;
         });
       }},
      {"spikes",
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double) { i.spike_ms = 50, i.spike_pause_s = 1; });
       }},
      {"step",  // 150 ms more for 4 s, where that stays below 400 ms
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double rtt) {
           i.step_ms = rtt > 250 ? 0 : 75, i.step_at_s = 3, i.step_length_s = 4;
         });
       }},
      {"drift",
       [](Condition& c) {
         both(c,
              [](ImpairmentConfig& i, double rtt) { i.delay_drift_ms_per_s = 0.1 / 60 * rtt / 2; });
       }},
      {"asymmetric",
       [](Condition& c) {
         c.forward.delay_ms = 0.2 * c.rtt_ms, c.backward.delay_ms = 0.8 * c.rtt_ms;
       }},
  };
  return kAll;
}
inline const std::vector<Trouble>& losses() {
  static const std::vector<Trouble> kAll = {
      {"no loss", [](Condition&) {}},
      {"random 1 %", [](Condition& c) { c.forward.loss_ratio = c.backward.loss_ratio = 0.01; }},
      {"bursts 1 %", [](Condition& c) { bursts(c, 0.002); }},
      {"bursts 5 %", [](Condition& c) { bursts(c, 0.2 * 5 / 95); }},
      {"bursts 10 %", [](Condition& c) { bursts(c, 0.2 * 10 / 90); }},
  };
  return kAll;
}
// While the hand presses, and once in free motion.
inline void black(Condition& c, double length) {
  for (ImpairmentConfig* i : {&c.forward, &c.backward})
    i->blackouts[0] = {.at_s = 3, .length_s = length},
    i->blackouts[1] = {.at_s = 7.5, .length_s = length};
}
// Beyond all methods: the rules of degradation.
inline const std::vector<Trouble>& outages() {
  static const std::vector<Trouble> kAll = {
      {"blackout 0.2 s", [](Condition& c) { black(c, 0.2); }},
      {"blackout 1 s", [](Condition& c) { black(c, 1); }},
      {"blackout 5 s", [](Condition& c) { black(c, 5); }},
      {"200 kbit/s, queue of 15 kB",
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double) {
           i.cap_kbit_per_s = 200, i.cap_queue_bytes = 15000;
         });
       }},
      {"200 kbit/s, queue of 1.5 kB",
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double) {
           i.cap_kbit_per_s = 200, i.cap_queue_bytes = 1500;
         });
       }},
  };
  return kAll;
}
inline const std::vector<Trouble>& others() {
  static const std::vector<Trouble> kAll = {
      {"", [](Condition&) {}},
      {"double 1 %, corrupt 0.1 %, held back 5 %",
       [](Condition& c) {
         both(c, [](ImpairmentConfig& i, double) {
           i.duplicate_ratio = 0.01, i.corrupt_ratio = 0.001, i.reorder_ratio = 0.05;
         });
       }},
  };
  return kAll;
}

inline Condition plain(double rtt_ms) {
  const ImpairmentConfig way{.delay_ms = rtt_ms / 2};
  return {.name = "constant", .rtt_ms = rtt_ms, .forward = way, .backward = way};
}

// 100 ms, 10 ms of jitter each way, 1 % lost in bursts: where the methods are compared.
inline Condition reference_condition(double rtt_ms = 100) {
  Condition c = plain(rtt_ms);
  c.name = "gamma, bursts 1 %";
  jitters()[1].apply(c), losses()[2].apply(c);
  return c;
}

// Every `stride`-th of all conditions of this delay.
inline std::vector<Condition> conditions(double rtt_ms, int stride = 1) {
  std::vector<Condition> out;
  int i = 0;
  for (const Trouble& jitter : jitters())
    for (const Trouble& loss : losses())
      for (const Trouble& other : others()) {
        if (i++ % stride != 0) continue;
        Condition c = plain(rtt_ms);
        jitter.apply(c), loss.apply(c), other.apply(c);
        c.name = jitter.name + ", " + loss.name + (other.name.empty() ? "" : ", " + other.name);
        out.push_back(c);
      }
  return out;
}

}  // namespace farhand::bench
