// On the reference's single-axis model (section 9.3) with the product's force controller.
#include <array>
#include <cmath>

#include "tests/loop/experiments/columns.hpp"
#include "tests/loop/experiments/experiment.hpp"
#include "tests/support/axis_loops.hpp"

namespace farhand {
namespace {

using axis::LoopConfig;

// As published, without noise; ours with what a real sensor and encoder add.
struct Contender {
  const char* name;
  LoopConfig loop;
};
std::array<Contender, 3> contenders(int queue) {
  const auto with = [queue](ForceControllerConfig controller) {
    return LoopConfig{.queue = queue, .controller = std::move(controller)};
  };
  LoopConfig ours = with(axis::ours(queue));
  ours.force_noise = 0.03, ours.encoder_step = 20e-6;
  return {{{"open loop", with(axis::open_loop())},
           {"published gains", with(axis::published())},
           {"ours", ours}}};
}

Chart free_motion_chart(const std::array<Contender, 3>& loops) {
  constexpr double kFrom = 30, kTo = 34, kSpan = 6.5;  // [s], [N]
  Chart chart{.title = "Force of the user in free motion"};
  for (const Contender& c : loops) {
    axis::Loop loop(c.loop);
    const auto wish = axis::h1_wish();
    Signal F;
    while (loop.last().t < kTo) {
      const axis::Tick& t = loop.tick(wish);
      if (t.t >= kFrom) F.add(t.t, t.F_u);
    }
    Panel p = over_time("F_u [N]", kFrom, kTo, {drawn(F, "user", 0, kFrom, kTo)});
    p.y.lo = -kSpan, p.y.hi = kSpan;
    p.note = c.name;
    chart.panels.push_back(std::move(p));
  }
  return chart;
}

Chart contact_chart(const Contender& c) {
  constexpr double kEnd = 25;
  Signal x, y, F_u, F_e;
  axis::Loop loop(c.loop);
  while (loop.last().t < kEnd) {
    const axis::Tick& t = loop.tick(axis::h2_wish);
    x.add(t.t, t.x), y.add(t.t, t.y);
    F_u.add(t.t, t.F_u), F_e.add(t.t, t.F_e);
  }
  Chart chart{.title = "Teleoperation with contact", .subtitle = c.name, .panel_height = 150};
  chart.panels = {
      over_time("position [mm]", 0, kEnd,
                {drawn(x, "handle", 0, 0, kEnd, 1e3), drawn(y, "robot", 1, 0, kEnd, 1e3)}),
      over_time("force [N]", 0, kEnd,
                {drawn(F_u, "F_u, user", 0, 0, kEnd), drawn(F_e, "F_e, robot", 1, 0, kEnd)})};
  return chart;
}

}  // namespace

Experiment free_motion_one_axis() {
  const std::array<Contender, 3> loops = contenders(1);
  std::array<Swing, 3> s;
  for (std::size_t i = 0; i < 3; ++i) s[i] = axis::swing(loops[i].loop, 1, 0.05, 30, 10);
  const auto gone = [&](std::size_t i, auto member) {
    return 100 * (1 - s[i].*member / (s[0].*member));
  };
  using S = Swing;
  Experiment out{.title = "H1  Free motion, one axis",
                 .about =
                     "The hand moves 50 mm to and fro at 1 Hz; the robot touches nothing. "
                     "Judged from 30 s to 40 s. Ours with force noise of 0.03 N and encoder "
                     "steps of 20 um."};
  out.figures = {
      {"open loop: mean of the user's force", "N", "", 2.00, s[0].mean, 1.8, 2.2},
      {"open loop: peak", "N", "", 5.60, s[0].peak, 5.04, 6.16},
      {"published gains: mean", "N", "no offset", 0.003, std::abs(s[1].mean), 0, 0.05},
      {"published gains: peak reduced by", "%", "more than 60", 71, gone(1, &S::peak), 60, 100},
      {"published gains: swing per mm reduced by", "%", "", 54.7, gone(1, &S::per_mm), 50, 60},
      {"ours: mean", "N", "", NAN, std::abs(s[2].mean), 0, 0.01},
      {"ours: swing per mm reduced by", "%", "", 95.8, gone(2, &S::per_mm), 94, 100},
      {"ours: component at 1 Hz reduced by", "%", "", 97.6, gone(2, &S::component), 98, 100},
      {"ours: felt noise", "mN rms", "", NAN, 1e3 * s[2].felt, 0, 15}};
  out.charts = {free_motion_chart(loops)};
  return out;
}

Experiment contact_one_axis() {
  std::array<Contender, 3> loops = contenders(0);
  for (Contender& c : loops) c.loop.wall = axis::Wall{};
  std::array<axis::Contact, 3> r;
  for (std::size_t i = 0; i < 3; ++i) r[i] = axis::contact(loops[i].loop);
  LoopConfig far = loops[2].loop;
  far.delay = 20, far.wall->k = 1000;
  Experiment out{.title = "H2, H3  Contact, one axis",
                 .about =
                     "The robot meets a wall of 500 N/m 30 mm away, 2 ms of network each way. "
                     "F_u - F_e judged from 16 s to 25 s."};
  out.figures = {
      {"H2, open loop: rms of F_u - F_e", "N", "visible", 2.12, r[0].rms, 1.9, 2.33},
      {"H2, open loop: largest", "N", "", 2.90, r[0].peak},
      {"H3, published gains: rms of F_u - F_e", "N", "F_u follows F_e", 0.334, r[1].rms},
      {"H3, published gains: share of the open loop's", "%", "", 15.8, 100 * r[1].rms / r[0].rms, 0,
       25},
      {"H3, ours: rms of F_u - F_e", "N", "", 0.14, r[2].rms, 0, 0.2},
      {"H3, ours: share of the open loop's", "%", "", NAN, 100 * r[2].rms / r[0].rms, 0, 10},
      {"H3, ours: rms on 1000 N/m at 20 + 20 ms", "N", "", NAN, axis::contact(far).rms, 0, 0.2}};
  for (const Contender& c : loops) out.charts.push_back(contact_chart(c));
  return out;
}

}  // namespace farhand
