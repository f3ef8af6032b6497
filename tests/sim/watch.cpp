#include "tests/sim/watch.hpp"

#include "common/alignment.hpp"
#include "common/codec.hpp"
#include "common/energy_budget.hpp"
#include "tests/loop/truth.hpp"

namespace farhand {

namespace {

// What all guards of the hand's port may give out together before anything came in [J].
double store_of(const CompensatedForceConfig& method) {
  if (const auto* c = std::get_if<DampedCouplingConfig>(&method)) return c->guard.store;
  if (const auto* c = std::get_if<MediatedCouplingConfig>(&method)) return c->tank.start;
  if (const auto* c = std::get_if<ChosenCouplingConfig>(&method))
    return c->mediated.tank.start + c->damped.guard.store;
  if (const auto* c = std::get_if<DirectCouplingConfig>(&method)) return c->translation.store;
  if (const auto* c = std::get_if<SmithCouplingConfig>(&method)) return c->guard.store;
  return kEnergyStore;  // waves
}

}  // namespace

Watch::Watch(const Loopback& loop, Checkers& checkers, Duration max_late)
    : loop_(loop), checkers_(checkers), max_late_(max_late) {
  if (const auto& method = loop.master().config().compensated) store_ = store_of(*method);
}

void Watch::restarted(Side side, std::uint64_t session) {
  if (side == Side::master) {
    master_mode_ = Mode::disconnected;
    master_session_ = session;
    slaves_session_ = 0;
    dead_man_ = false;
    energy_ = 0;
    told_before_ = -told_;
    F_M_.reset();
    not_in_order_ = loop_.now();
    return;
  }
  slave_mode_ = Mode::disconnected;
  masters_session_ = 0;
  slave_began_ = loop_.now();
  q_cmd_.reset();
  q_MR_.reset();
  coupled_ = false;
  rested_ = kRested;
  told_before_ += told_;
  told_ = 0;
}

// Within a session the numbers of what is acted upon grow, and every datagram is accounted for.
template <typename Link>
void Watch::check_link(const Link& link, std::uint64_t& session, std::uint64_t& sequence) {
  const LinkCounters& c = link.counters();
  checkers_.expect(c.received == c.accepted() + c.dropped(), "datagrams not accounted for",
                   static_cast<double>(c.received),
                   static_cast<double>(c.accepted() + c.dropped()));
  checkers_.expect(c.refused_to_send == 0, "own messages not valid",
                   static_cast<double>(c.refused_to_send), 0);
  if (link.newest() == nullptr) return;
  if (session != link.peer()->session) session = link.peer()->session, sequence = 0;
  checkers_.expect(link.newest()->sequence >= sequence, "an older message is acted upon",
                   static_cast<double>(link.newest()->sequence), static_cast<double>(sequence));
  sequence = link.newest()->sequence;
}

namespace {

template <typename Link>
Duration silence(const Link& link, TimePoint now) {
  return link.newest() != nullptr ? now - link.newest()->received : Duration::max();
}

}  // namespace

void Watch::sampling() {
  const MasterLink& link = loop_.master_end();
  silent_ = silence(link, loop_.clock(Side::master).local(loop_.now()));
  // The slave moves by it before the master's tick has ended.
  const std::uint64_t next = link.sequence() + 1;
  sent_[next % sent_.size()] = {master_session_, next, loop_.now()};
}

void Watch::check(const MasterTick& t) {
  const MasterLink& link = loop_.master_end();
  check_link(link, slaves_session_, slaves_sequence_);
  const TimePoint sampled = loop_.clock(Side::master).truth(t.now);
  checkers_.expect(valid(t.out), "a message of the master that cannot be sent", NAN, 0);

  if (t.reading.dead_man && !dead_man_) {
    pressed_at_ = sampled;
    pressed_[{master_session_, t.out.dead_man_presses}] = sampled;
  }
  dead_man_ = t.reading.dead_man;
  if (t.mode == Mode::engaged) {
    checkers_.expect(silent_ <= loop_.master().config().stale,
                     "master ENGAGED without a fresh message, silent for [s]", seconds(silent_), 0);
    checkers_.expect(master_mode_ == Mode::engaged || pressed_at_ > not_in_order_,
                     "master ENGAGED by a press older than the interruption, by [s]",
                     seconds(not_in_order_ - pressed_at_), 0);
  }
  if (t.mode != Mode::engaged && t.mode != Mode::ready) not_in_order_ = sampled;
  master_mode_ = t.mode;
  if (store_ > 0) check_energy(t);
}

// What the coupling gave the hand is no more than the slave says it put in, and the store.
void Watch::check_energy(const MasterTick& t) {
  const Vec3 p_MH = true_handle(loop_.device(), t.handle.X_MH.p);
  const bool felt = !t.F_env_G.force.isZero();
  if (felt && F_M_) energy_ += F_M_->force.dot(p_MH - p_MH_);
  F_M_.reset();
  if (felt) F_M_ = Wrench{.force = t.handle.R_MG * t.F_env_G.force};
  p_MH_ = p_MH;
  checkers_.expect(energy_ + store_ + told_before_ + told_ >= 0,
                   "energy given to the hand beyond what came in [J]", -energy_,
                   store_ + told_before_ + told_);
}

void Watch::check(const SlaveTick& t) {
  const SlaveLink& link = *loop_.slave_end();
  check_link(link, masters_session_, masters_sequence_);
  checkers_.expect(valid(t.out), "a message of the slave that cannot be sent", NAN, 0);
  checkers_.expect(t.X_SE_target.p.allFinite() && t.X_SE_target.R.allFinite() &&
                       t.q_cmd.allFinite() && is_finite(t.F_E_S),
                   "slave not finite", NAN, 0);
  told_ = t.out.energies.translation + t.out.wave.E;

  const Duration silent = silence(link, t.now);
  const bool fresh = silent <= loop_.slave()->config().stale;
  checkers_.expect(t.mode != Mode::engaged || fresh,
                   "slave ENGAGED without a fresh message, silent for [s]", seconds(silent), 0);
  checkers_.expect(!t.coupled || t.mode == Mode::engaged, "coupled but not ENGAGED", 0, 0);
  const bool found = !robot_read_ && t.robot.ok && t.q_cmd == t.robot.q;  // held where it is
  const bool moved = q_cmd_ && *q_cmd_ != t.q_cmd && !found;
  checkers_.expect(!moved || (t.coupled && fresh), "the command moved without a fresh order", 0, 0);
  if (moved) check_age();
  check_place(t);
  check_turn(t);
  q_cmd_ = t.q_cmd;
  robot_read_ = t.robot.ok;
  if (t.mode == Mode::engaged && slave_mode_ != Mode::engaged) check_press(t);
  slave_mode_ = t.mode;
}

// A robot that reads well and has come to rest is told to be about where it is, whatever one
// reading said. (Following, the wrist may be far behind its command close by a singularity.)
void Watch::check_place(const SlaveTick& t) {
  constexpr int kWell = 5;        // [ticks]
  constexpr double kAbout = 0.3;  // [rad]
  read_well_ = t.robot.ok ? read_well_ + 1 : 0;
  rested_ = t.coupled ? 0 : rested_ + 1;
  const auto truth = std::visit([](const auto& r) { return r.truth(); }, *loop_.robot());
  const double off = (t.q_cmd - truth.q).cwiseAbs().maxCoeff();
  checkers_.expect(read_well_ < kWell || rested_ < kRested || off <= kAbout,
                   "the command is far from where the robot is [rad]", off, kAbout);
}

// With alignment the robot follows no handle that is turned otherwise than it was told to be.
void Watch::check_turn(const SlaveTick& t) {
  const auto& alignment = loop_.slave()->config().workspace.alignment;
  if (alignment && t.coupled && !coupled_ && q_MR_) {
    const Quat& q_MH = loop_.slave_end()->newest()->message.q_MH;
    const double off = q_MR_->angularDistance(q_MH), most = Alignment::kRoom * *alignment;
    checkers_.expect(off <= most, "coupled with the handle turned away by [rad]", off, most);
  }
  coupled_ = t.coupled;
  q_MR_.reset();
  if (!t.coupled && t.out.has_robot) q_MR_ = t.out.q_MR;
}

void Watch::received(bool forged, bool accepted) {
  checkers_.expect(!forged || !accepted, "a forged datagram was accepted", 1, 0);
}

// Every engagement takes a press of its own, made since this process began.
void Watch::check_press(const SlaveTick& t) {
  const auto* in = loop_.slave_end()->newest();
  if (in == nullptr) return;
  const Press press{masters_session_, t.out.dead_man_presses_seen};
  checkers_.expect(used_.insert(press).second, "slave ENGAGED again by the same press",
                   static_cast<double>(press.second), 0);
  const auto made = pressed_.find(press);
  if (made == pressed_.end()) return;  // another master's
  checkers_.expect(made->second > slave_began_,
                   "slave ENGAGED by a press older than itself, by [s]",
                   seconds(slave_began_ - made->second), 0);
}

// The order a tick moves by is no older than the fastest of the clock's window took, the link's
// max_late on top, and the time it may have waited here. A clock that steps takes the link two
// quarter seconds to see.
void Watch::check_age() {
  constexpr Duration kRelearn = std::chrono::seconds(1);
  const auto* in = loop_.slave_end()->newest();
  if (in == nullptr) return;
  const Sent& sent = sent_[in->sequence % sent_.size()];
  if (sent.session != masters_session_ || sent.sequence != in->sequence) return;
  const TimePoint now = loop_.now();
  const Duration age = now - sent.at;
  const auto second = std::chrono::floor<std::chrono::seconds>(now);
  Fastest& open =
      fastest_[static_cast<std::size_t>(second.time_since_epoch().count()) % fastest_.size()];
  if (open.from != second) open = {second, Duration::max()};
  open.took = std::min(open.took, age);
  oldest_command_ = std::max(oldest_command_, age);
  if (clock_stepped_ && now - *clock_stepped_ < kRelearn) return;
  Duration least = Duration::max();
  for (const Fastest& f : fastest_)
    if (now - f.from <= ClockSync::kWindow + 2 * kRelearn) least = std::min(least, f.took);
  const Duration most = least + max_late_ + loop_.slave()->config().stale;
  checkers_.expect(age <= most, "the command moved by an order of age [s]", seconds(age),
                   seconds(most));
}

}  // namespace farhand
