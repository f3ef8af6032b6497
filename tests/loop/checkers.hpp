// Looks at the plant's side of the loop, after the limits, every tick: what must never happen
// whatever the hand, the network or the robot does. A violation ends nothing; it is kept and makes
// the run fail.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/loop/loopback.hpp"

namespace farhand {

struct Violation {
  double at_s = 0;
  std::string what;
};

class Checkers {
 public:
  explicit Checkers(const Loopback& loop);

  void check(const MasterTick& tick);
  void check(const SlaveTick& tick);
  // A new process: what was before was another's.
  void restarted(Side side) noexcept;

  // Kept as a violation, of the present instant, if it is not good.
  void expect(bool good, const char* what, double value, double limit);

  std::uint64_t count() const noexcept { return count_; }
  const std::vector<Violation>& first() const noexcept { return first_; }  // the first few

 private:
  void check_handle(const MasterTick& tick);
  void check_position_control(const MasterTick& tick);
  void check_boundary(const SlaveTick& tick);

  const Loopback& loop_;
  std::uint64_t count_ = 0;
  std::vector<Violation> first_;
  Mode master_mode_ = Mode::disconnected, slave_mode_ = Mode::disconnected;
  Vec6 motor_tau_ = Vec6::Zero();
  Wrench F_G_;
  Wrench boundary_;
  bool slave_seen_ = false, robot_read_ = true;
  Vec6 q_cmd_ = Vec6::Zero();
  Vec6 joint_tau_ = Vec6::Zero();
};

}  // namespace farhand
