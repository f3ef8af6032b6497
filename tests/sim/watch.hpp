// What must never happen in an episode, looked for at every tick, beyond what the checkers of any
// loop look for (tests/loop/checkers.hpp). It knows the truth: when a press was made, when a
// message was sent, which process is which.
#pragma once

#include <array>
#include <map>
#include <set>

#include "tests/loop/checkers.hpp"

namespace farhand {

class Watch {
 public:
  // max_late: of the link.
  Watch(const Loopback& loop, Checkers& checkers, Duration max_late);

  void sampling();  // just before the master's sample decides its state
  void check(const MasterTick& tick);
  void check(const SlaveTick& tick);
  void received(bool forged, bool accepted);
  void restarted(Side side, std::uint64_t session);
  // The link forgets how fast the way was.
  void clock_stepped() {
    clock_stepped_ = loop_.now();
    fastest_ = {};
  }

  Duration oldest_command() const noexcept { return oldest_command_; }

 private:
  using Press = std::pair<std::uint64_t, std::uint32_t>;  // session of the master, its count

  template <typename Link>
  void check_link(const Link& link, std::uint64_t& session, std::uint64_t& sequence);
  void check_press(const SlaveTick& tick);
  void check_age();
  void check_place(const SlaveTick& tick);
  void check_turn(const SlaveTick& tick);
  void check_energy(const MasterTick& tick);

  const Loopback& loop_;
  Checkers& checkers_;

  Mode master_mode_ = Mode::disconnected, slave_mode_ = Mode::disconnected;
  std::uint64_t slaves_session_ = 0, slaves_sequence_ = 0;    // as the master heard, and
  std::uint64_t masters_session_ = 0, masters_sequence_ = 0;  // as the slave did

  std::set<Press> used_;                // presses that have engaged the slave
  std::map<Press, TimePoint> pressed_;  // when, by the operator
  TimePoint pressed_at_{}, not_in_order_{}, slave_began_{};
  bool dead_man_ = false;
  Duration silent_ = Duration::max();  // the slave, at the master's sample
  std::uint64_t master_session_ = 1;

  // When the master sent its messages, by their numbers.
  struct Sent {
    std::uint64_t session = 0, sequence = 0;
    TimePoint at{};
  };
  std::array<Sent, 4096> sent_{};
  // How long messages truly took until a tick moved by them: least of each second, and when.
  struct Fastest {
    TimePoint from{};
    Duration took = Duration::max();
  };
  std::array<Fastest, 12> fastest_{};
  std::optional<TimePoint> clock_stepped_;
  Duration max_late_;
  Duration oldest_command_{};
  std::optional<Vec6> q_cmd_;
  bool robot_read_ = true;
  bool coupled_ = false;
  std::optional<Quat> q_MR_;  // of the last tick: how the handle must be turned
  static constexpr int kRested = 500;
  int read_well_ = 0, rested_ = kRested;  // ticks on end

  // Of the port where a compensation guards the hand.
  double store_ = 0, energy_ = 0, told_before_ = 0, told_ = 0;
  std::optional<Wrench> F_M_;
  Vec3 p_MH_ = Vec3::Zero();
};

}  // namespace farhand
