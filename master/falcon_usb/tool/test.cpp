#include <cstdio>
#include <stdexcept>

#include "common/realtime.hpp"
#include "master/falcon_usb/tool/commands.hpp"
#include "master/falcon_usb/tool/hold.hpp"

namespace farhand::falcon_usb {
namespace {

bool report(bool good, const std::string& what, const std::string& remedy) {
  std::printf("%-6s %s%s%s\n", good ? "ok" : "FAILED", what.c_str(), good ? "" : ": ",
              good ? "" : remedy.c_str());
  return good;
}

bool exchange(Session& session) {
  constexpr Duration kLook = std::chrono::seconds(5);
  constexpr double kLeastRate = 900;
  const ExchangeCounters before = session.driver().status().exchange;
  session.run(kLook, [](TimePoint) { return false; });
  const ExchangeCounters after = session.driver().status().exchange;
  const double rate = static_cast<double>(after.accepted - before.accepted) / seconds(kLook);
  const auto again = after.unanswered - before.unanswered;
  return report(rate >= kLeastRate && again < 50,
                std::to_string(static_cast<int>(rate)) + " exchanges per second, " +
                    std::to_string(again) + " asked again",
                "connect it without a hub, and see that no other program keeps the machine busy");
}

bool button(Session& session, const char* name, std::uint8_t bit) {
  constexpr Duration kPatience = std::chrono::seconds(20);
  std::fprintf(stderr, "press the %s button\n", name);
  const bool seen = session.run(kPatience, [&](TimePoint) {
    const auto& s = session.driver().newest();
    return s && s->answer.buttons == bit;
  });
  return report(seen, std::string("button ") + name, "not seen alone within 20 s");
}

// How far from `to` the grip comes to rest [m], or nothing if it was lost on the way. If it stops
// answering on the way, which takes the force away, the user arms it again.
std::optional<double> drive(Session& session, Hold& hold, const Vec3& to) {
  constexpr int kWay = 2500;  // samples
  std::optional<Hold::Step> step;
  for (bool again = true; again;) {
    hold.go(to);
    session.run_samples(kWay, [&](TimePoint now, const Sample&) {
      step = hold.step(now, session.driver().read(now));
      session.driver().write(now, step ? step->tau : Vec6(Vec6::Zero()));
      return !session.armed() || (step && step->lost);
    });
    session.driver().write(monotonic_now(), Vec6::Zero());
    again = !session.armed();
    if (again) session.reach(Phase::armed, kHands);
  }
  if (!step || step->lost) return {};
  return (step->p_MH - to).norm();
}

bool forces(Session& session, const FalconGeometry& geometry) {
  constexpr double kReach = 0.015, kNear = 0.005;  // [m]
  const char* lost = "lost on the way: held by hand, weak, or pushed the wrong way";
  const Vec3 centre(0, 0, 0.115);
  Hold hold(geometry);
  // The first time to find out what the grip weighs, which differs.
  if (!drive(session, hold, centre)) return report(false, "driven to the centre", lost);
  hold.weigh();
  bool good = true;
  for (const Vec3& way : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0),
                          Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    const auto off = drive(session, hold, centre + kReach * way);
    char what[80];
    std::snprintf(what, sizeof what, "driven to (%+.0f %+.0f %+.0f) mm of the centre",
                  1e3 * kReach * way.x(), 1e3 * kReach * way.y(), 1e3 * kReach * way.z());
    if (!off) return report(false, what, lost);
    char text[20];
    std::snprintf(text, sizeof text, ", %.1f mm off", 1e3 * *off);
    good = report(*off < kNear, what + std::string(text), "weak motors, or something in the way") &&
           good;
  }
  return good;
}

}  // namespace

int test(Session& session, const FalconGeometry& geometry) {
  session.reach(Phase::homed, kHands);
  bool good = exchange(session);
  for (const auto& [name, bit] :
       {std::pair{"centre", kButtonCentre}, std::pair{"forward", kButtonForward},
        std::pair{"plus (right)", kButtonPlus}, std::pair{"minus (left)", kButtonMinus}})
    good = button(session, name, bit) && good;
  std::fputs(
      "now the motors, which drive the grip 15 mm each way for 20 s: hold it lightly, press the "
      "centre and the forward button together for half a second, and let all of it go\n",
      stderr);
  session.reach(Phase::armed, kHands);
  good = forces(session, geometry) && good;
  std::puts(good ? "all is as it should be; the motors are off, and the grip sinks"
                 : "not all is as it should be: see the lines that say FAILED");
  return good ? 0 : 1;
}

}  // namespace farhand::falcon_usb
