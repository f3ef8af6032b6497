// Beyond what the methods are made for: the network is gone for a while, or a queue delays all by a
// second. By rule the coupling fades, ends, and is taken up again from where the hand is.
#include <gtest/gtest.h>

#include <memory>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"

namespace farhand::bench {
namespace {

struct Named {
  const char* name;
  std::unique_ptr<Method> method;
};
std::vector<Named> methods() {
  std::vector<Named> out;
  out.push_back({"damped", std::make_unique<Damped>()});
  out.push_back({"touch", std::make_unique<Damped>(touching())});
  out.push_back({"mmt", std::make_unique<Mediated>()});
  return out;
}

TEST(Outages, DegradeOrDisengageAndNeverDiverge) {
  for (const Trouble& outage : outages())
    for (const double rtt : {20., 100., 400.})
      for (const double k : kWalls)
        for (const Named& m : methods()) {
          Condition c = plain(rtt);
          outage.apply(c);
          double fastest = 0;
          const Figures f = run(c.rig(k), *m.method, c.T1(), [&](const Sample& a) {
            fastest = std::max(fastest, std::abs(a.v_s));
          });
          const auto what = testing::Message()
                            << outage.name << ' ' << rtt << ' ' << k << ' ' << m.name;
          EXPECT_TRUE(f.finite) << what;
          EXPECT_LE(f.peak_F, 15) << what;
          EXPECT_LE(f.peak_F_e, 25) << what;
          EXPECT_LE(fastest, 0.7) << what;
          EXPECT_GE(f.operator_least, -2 * kEnergyStore) << what;
          if (k == 1000 && rtt == 100)
            std::printf(
                "%-28s %-6s hand %.1f N, wall %.1f N, robot %.2f m/s at most; chatter "
                "%.2f mm/s\n",
                outage.name.c_str(), m.name, f.peak_F, f.peak_F_e, fastest, 1e3 * f.chatter);
        }
}

// While nothing comes neither side drives: the hand feels a drag at most (12 N s/m at 0.09 m/s),
// the robot rests.
TEST(Outages, NothingMovesWhileTheNetworkIsGone) {
  for (const Named& m : methods()) {
    Condition c = plain(100);
    black(c, 5);
    double force = 0, speed = 0;
    run(c.rig(1000), *m.method, c.T1(), [&](const Sample& a) {
      if (a.t < 4.6 || a.t > 8) return;  // 1.6 s after the last message was sent
      force = std::max(force, std::abs(a.F)), speed = std::max(speed, std::abs(a.v_s));
    });
    EXPECT_LT(force, 12 * 0.09) << m.name;
    EXPECT_LT(speed, 0.001) << m.name;
  }
}

}  // namespace
}  // namespace farhand::bench
