// Every method side by side: what is felt of the wall and the drag, by delay and stiffness.
#include <gtest/gtest.h>

#include <memory>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/stress.hpp"

namespace farhand::bench {
namespace {

using MakeMethod = std::unique_ptr<Method> (*)(double k);
struct Row {
  const char* name;
  MakeMethod make;
  bool always_stable;
};
const Row kRows[] = {
    {"direct", [](double) -> std::unique_ptr<Method> { return std::make_unique<Direct>(1, false); },
     false},
    {"direct, guarded",
     [](double) -> std::unique_ptr<Method> { return std::make_unique<Direct>(1, true); }, false},
    {"damped", [](double) -> std::unique_ptr<Method> { return std::make_unique<Damped>(); }, true},
    {"damped, touch",
     [](double) -> std::unique_ptr<Method> { return std::make_unique<Damped>(touching()); }, true},
    {"wave", [](double) -> std::unique_ptr<Method> { return std::make_unique<Wave>(WaveConfig{}); },
     true},
    {"smith",
     [](double k) -> std::unique_ptr<Method> {
       SmithConfig c;
       c.wall = {.known = true, .x_w = along(kWall), .n = along(1), .k = k, .b = 5};
       return std::make_unique<Smith>(c);
     },
     true},
    {"mmt", [](double) -> std::unique_ptr<Method> { return std::make_unique<Mediated>(); }, true},
};

TEST(Map, OfWhatIsFeltByDelayStiffnessAndMethod) {
  std::vector<double> rtts = {5, 100, 400};
  if (stress_ticks(0) > 0) rtts = {5, 20, 50, 100, 200, 400};
  std::printf("felt of the wall / drag [N]; -: chatters\n%-24s", "");
  for (const double rtt : rtts) std::printf("%6.0f ms   ", rtt);
  for (const double k : kWalls)
    for (const Row& row : kRows) {
      std::printf("\n%4.0f N/m, %-14s", k, row.name);
      for (const double rtt : rtts) {
        const Condition c = reference_condition(rtt);
        const auto method = row.make(k);
        const Figures f = run(c.rig(k), *method, c.T1());
        const bool stable = f.finite && f.chatter < 0.005;
        EXPECT_TRUE(stable || !row.always_stable) << row.name << ' ' << k << ' ' << rtt;
        stable ? std::printf("%6.2f /%4.1f", f.felt, f.drag) : std::printf("%12s", "-");
      }
    }
  std::printf("\n");
}

TEST(Methods, TakeNothingFromTheHeapInATick) {
  for (const Row& row : kRows) {
    const auto method = row.make(1000);
    Bench bench(reference_condition().rig(1000), *method);
    double t = 0;
    const auto tick = [&] {
      bench.tick(wish(t, kHold), wish(t + Bench::kTs, kHold));
      t += Bench::kTs;
    };
    while (t < 0.5) tick();
    EXPECT_EQ(allocations_in([&] {
                while (t < 9) tick();
              }),
              0)
        << row.name;
  }
}

}  // namespace
}  // namespace farhand::bench
