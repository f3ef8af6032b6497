// Wave variables (Niemeyer and Slotine 1991, IEEE J. Oceanic Eng. 16, 152), the part that both
// sides share. Instead of force and velocity the sides send
//
//   u = (b v + F) / sqrt(2 b)  to the slave      w = (b v - F) / sqrt(2 b)  back
//
// With them the network is passive at any constant delay. For one that varies, and for losses, the
// integrals of the wave and of its energy are sent (Niemeyer and Slotine 1998, IEEE ICRA): the
// receiver gives out what is still missing,
//
//   u = (U - U_out) / tau,   |u| <= sqrt(2 (E - E_out) / Ts)
//
// and never more energy than was sent: any later message makes up for lost ones, the order and
// duplicates do not matter, and position is kept. "Newest wins" lets the energy limit eat the
// signal under jitter, so the sums go through a playout buffer (common/playout.hpp).
//
// Costs: the wall is felt in series with the network, 1 / (1 / ke + T / b), T one way with tau and
// the playout; inertia of b T; reflections where nothing is matched to b. Gaps: the wave is zero,
// the sides feel a damper b; what was missing comes after it as fast as its energy allows, a knock
// where the gap outlasts the playout.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/geometry.hpp"
#include "common/playout.hpp"
#include "common/wave_sum.hpp"

namespace farhand {

struct WaveConfig {
  double Ts = 0.001;
  double b = 20;       // impedance [N s/m], [N m s]
  double tau = 0.004;  // [s] of the reconstruction
  PlayoutConfig playout;
};

class WaveReceiver {
 public:
  explicit WaveReceiver(const WaveConfig& config) noexcept
      : config_(config), playout_(config.playout) {}

  void push(Duration sent, const WaveSum& sum, Duration now) noexcept {
    playout_.push(sent, sum, now);
  }
  // The wave of this tick.
  Vec3 step(Duration now) noexcept {
    const WaveSum rest = playout_.play(now) - out_;
    const double most = std::sqrt(2 * std::max(rest.E, 0.0) / config_.Ts);
    Vec3 wave = rest.U / config_.tau;
    const double size = wave.norm();
    if (size > most) wave *= most / size;
    out_ = after(out_, wave, config_.Ts);
    return wave;
  }
  // A coupling begins: what the newest message sums up was meant for another one, and is not
  // played.
  void start() noexcept {
    out_ = playout_.newest();
    playout_.settle();
  }
  // Another sender: its sums and its clock begin anew.
  void clear() noexcept { *this = WaveReceiver(config_); }
  double delay() const noexcept { return playout_.delay(); }  // [s] of the playout

 private:
  WaveConfig config_;
  Playout<WaveSum> playout_;
  WaveSum out_;
};

}  // namespace farhand
