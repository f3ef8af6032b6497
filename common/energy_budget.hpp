// What a port of the network may give out (time-domain passivity: Ryu, Artigas and Preusche 2010,
// Mechatronics 20, 812). The energy of each port is kept split by sign, as two sums that only grow,
// from the network's point of view: `in` went in at the port, `out` came out of it. Each message
// carries the sender's `in`. Then, whatever the network loses, delays, doubles or reorders,
//
//   W = E0 + in of the peer, as received - out of our own + what the guard took away here >= 0
//
// on both sides keeps the whole network with both guards from ever giving out more than 2 E0.
//
// A pool comes before both sums: what goes in fills it and is told to the peer only where it runs
// over; what comes out is taken from it first. Without it the to and fro of a hand that holds, and
// the noise of encoders under force, is told as `in` for the peer to give out, and must come out
// here at the store's expense: a hand that pressed for some seconds had spent it.
//
// Where asked for, a surplus goes back: of what a side has beyond 2 E0 nine tenths are told to the
// peer as `in`, the rest is forgotten. Without springs and dampers in the network the peer of a
// robot that lags else pays for every withdrawal from a wall, and never gets anything back. Dampers
// pay for a wall that rings in that way, too; so not with them.
#pragma once

#include <algorithm>

namespace farhand {

inline constexpr double kEnergyStore = 0.02;  // E0 [J]: below it nothing starts to move

class EnergyBudget {
 public:
  explicit EnergyBudget(double store = kEnergyStore, bool returns_surplus = false) noexcept
      : store_(store), returns_surplus_(returns_surplus), credit_(store) {}

  // Of any message of the peer's session, in any order, any number of times.
  void receive(double peer_in) noexcept { received_ = std::max(received_, peer_in); }
  // Work [J] that went into the network at this port; negative: came out.
  void charge(double work) noexcept {
    pool_ += work;
    const double kept = std::clamp(pool_, 0.0, kPoolShare * store_);
    in_ += std::max(pool_ - kept, 0.0);
    out_ += std::max(kept - pool_, 0.0);
    pool_ = kept;
    if (returns_surplus_) return_surplus();
  }
  // Work [J] the guard took from the user or the robot by itself.
  void repay(double work) noexcept { credit_ += work; }

  // Of a surplus only so much is kept [J]; E0 where the method changed.
  void cap(double most) noexcept { credit_ -= std::max(left() - most, 0.0); }
  void cap() noexcept { cap(store_); }

  double left() const noexcept { return credit_ + received_ - out_ + pool_; }  // W, and the pool
  double in() const noexcept { return in_; }                                   // to be sent
  double out() const noexcept { return out_; }

  // The peer counts from 0 again. No more than E0 of what was left is kept.
  void restart() noexcept {
    credit_ = std::min(left(), store_) + out_ - pool_;
    received_ = 0;
  }

 private:
  void return_surplus() noexcept {
    const double surplus = std::max(left() - 2 * store_, 0.0);
    credit_ -= surplus;
    in_ += kReturned * surplus;
  }

  static constexpr double kReturned = 0.9;
  static constexpr double kPoolShare = 0.5;  // of E0, so that the peer can begin on its own E0

  double store_;
  bool returns_surplus_;
  double credit_;
  double received_ = 0, in_ = 0, out_ = 0, pool_ = 0;
};

}  // namespace farhand
