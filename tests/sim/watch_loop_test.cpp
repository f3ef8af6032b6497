// Checkers that look at a whole loop, shown loops in which what they look for is wrong.
#include <gtest/gtest.h>

#include "common/scene_network.hpp"
#include "tests/loop/pressing.hpp"
#include "tests/sim/attacker.hpp"
#include "tests/sim/plan_scene.hpp"
#include "tests/sim/watch.hpp"

namespace farhand {
namespace {

class Watched {
 public:
  explicit Watched(const Scene& scene, double duration_s = 3)
      : loop(scene, {.duration_s = duration_s}),
        checkers(loop),
        watch(loop, checkers, std::chrono::milliseconds(100)) {
    loop.on_reading = [this](HandleReading&) { watch.sampling(); };
    loop.on_master = [this](MasterTick t) {
      spoil(t);
      watch.check(t);
    };
    loop.on_slave = [this](const SlaveTick& t) { watch.check(t); };
  }
  void run_to(double t) { loop.run_until(loop.start() + from_seconds(t)); }
  // The first violations.
  std::string verdict() {
    loop.run();
    std::string out;
    for (const Violation& v : checkers.first()) out += v.what + "\n";
    return out;
  }

  Loopback loop;
  Checkers checkers;
  Watch watch;
  std::function<void(MasterTick&)> spoil = [](MasterTick&) {};
};

void expect_told(const std::string& verdict, const std::string& what) {
  EXPECT_NE(verdict.find(what), std::string::npos) << verdict;
}

constexpr std::array<const char*, 6> kGuarded = {"damped", "mmt",  "auto",
                                                 "direct", "wave", "smith"};

// What the hand put into the wall came out of it.
TEST(WatchLoop, RefusesACompensationThatGivesTheHandEnergy) {
  for (const char* method : kGuarded) {
    Scene scene = pressing_over(40, 500, false);
    choose_method(scene, method);
    EXPECT_EQ(Watched(scene, 5).verdict(), "");
    Watched wrong(scene, 5);
    wrong.spoil = [](MasterTick& t) { t.F_env_G.force = -t.F_env_G.force; };
    expect_told(wrong.verdict(), "energy given to the hand beyond what came in");
  }
}

// Two processes that pretend to be those before them.
TEST(WatchLoop, RefusesAnOlderMessage) {
  Watched w(shipped("twin_delta_free"));
  w.run_to(1.5);
  w.loop.restart(Side::master, std::chrono::milliseconds(1), 1);
  w.loop.restart(Side::slave, std::chrono::milliseconds(1), 2);
  expect_told(w.verdict(), "an older message is acted upon");
}

// What waited in the socket of a slave that slept, oldest first.
TEST(WatchLoop, RefusesOrdersOfThePast) {
  Scene scene = shipped("twin_delta_free");
  scene.proto.mutable_link()->set_stale_ms(200);  // of a master that does not hold at once
  EXPECT_EQ(Watched(scene).verdict(), "");
  for (const bool refused : {true, false}) {
    if (!refused) scene.proto.mutable_link()->set_max_late_ms(10000);
    Watched w(scene);
    w.run_to(1.5);
    w.loop.stall(Side::slave, std::chrono::seconds(1));
    if (refused)
      EXPECT_EQ(w.verdict(), "");
    else
      expect_told(w.verdict(), "the command moved by an order of age");
  }
}

// A channel that takes for genuine whatever comes, and a stranger who knows the session.
TEST(WatchLoop, RefusesAForgeryThatWasTaken) {
  const Scene scene = shipped("twin_delta_free");
  for (const bool taken : {false, true}) {
    Watched w(scene);
    Attacker attacker(1, false);
    MasterLink stranger(link_config(scene, 1));
    w.loop.on_sent = [&](Side to, auto d) {
      attacker.overhear(to, d);
      if (to == Side::master) stranger.receive(d, w.loop.now());
    };
    w.loop.on_arrival = [&](Side to, auto d) {
      return taken && to == Side::slave && attacker.made(d) ? stranger.encode({}, w.loop.now()) : d;
    };
    w.loop.on_received = [&](Side, auto d, bool accepted) {
      w.watch.received(attacker.made(d), accepted);
    };
    w.run_to(1.5);
    for (int i = 0; i < 5000; ++i) stranger.encode({}, w.loop.now());  // numbers not used yet
    attacker.forge(w.loop, 20);
    if (taken)
      expect_told(w.verdict(), "a forged datagram was accepted");
    else
      EXPECT_EQ(w.verdict(), "");
  }
}

}  // namespace
}  // namespace farhand
