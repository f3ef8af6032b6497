#include "tests/sim/episode.hpp"

#include <spdlog/fmt/fmt.h>

#include <deque>

#include "common/build_info.hpp"
#include "common/scene_network.hpp"
#include "master/record.hpp"
#include "slave/record.hpp"
#include "tests/loop/replay.hpp"
#include "tests/sim/attacker.hpp"
#include "tests/sim/keyed_channel.hpp"
#include "tests/sim/plan_scene.hpp"
#include "tests/sim/tracking.hpp"
#include "tests/sim/user.hpp"
#include "tests/sim/watch.hpp"
#include "tests/support/senseless.hpp"

namespace farhand {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);
constexpr Duration kMostToReady = std::chrono::seconds(5);
constexpr Duration kSettling = std::chrono::seconds(1);  // after engaging, until the lag counts

// The most of some hundred episodes, and a half on top; 1500 stay within.
Tracking::Limits limits_of(const Plan& plan) {
  constexpr double kRoom = 1.5;
  Tracking::Limits out{.tool = 1.0e-3 * kRoom};
  if (plan.scene == "minimal") out.tool = 1.7e-3 * kRoom;  // friction is not compensated
  const std::string& m = plan.method;
  if (m == "damped" || m == "auto") out.command = 5.7e-3 * kRoom;  // on a spring
  // Where a guard has run dry the sensor's noise alone holds the command off.
  if (m == "direct") out.command = 1.4e-3 * kRoom;
  if (m == "wave") out.command = 1.0e-3 * kRoom;
  // The longest playout, and what the reconstruction takes.
  if (m == "wave" || m == "smith") out.played_out = 280;
  if (m == "wave") out.played_out *= 3;  // it goes back, and comes again
  out.keeps_offset = m == "wave";
  return out;
}

std::optional<Tracking::Wall> wall_of(const Scene& scene) {
  const auto& arm = scene.proto.slave().sim_arm();
  if (arm.surface_size() == 0) return {};
  const proto::Plane& plane = arm.surface(0).plane();
  const auto vector = [](const auto& v) { return Vec3(v[0], v[1], v[2]); };
  return Tracking::Wall{vector(plane.point_m()), vector(plane.normal()).normalized()};
}

LoopbackOptions options_of(const Plan& plan) {
  return {.seed = plan.seed,
          .duration_s = seconds(plan.end),
          .master_clock = plan.master_clock,
          .slave_clock = plan.slave_clock};
}

class Recorded {
 public:
  Recorded(const std::string& path, const Scene& scene, const LoopbackOptions& options,
           const SlaveConfig& slave)
      : file_(path, scene, about_loopback(scene, options, build_info())),
        master_(file_, scene.proto),
        slave_(file_, slave) {}
  void add(const Loopback& loop, const MasterTick& t) {
    master_.add({t, {}, loop.master_status()});
  }
  void add(const Loopback& loop, const SlaveTick& t) { slave_.add({t, {}, loop.slave_status()}); }
  void end() { file_.end(); }

 private:
  RecordingFile file_;
  MasterRecording master_;
  SlaveRecording slave_;
};

class Episode {
 public:
  Episode(const Plan& plan, const EpisodeOptions& options);
  EpisodeResult run();

 private:
  void begin(const Fault& fault);
  void end(const Fault& fault);
  void start_process(Side side, Duration length);
  void start_channel(Side side);
  void act();
  void handshake(Side side);
  void press(HandleReading& reading);
  void on(const MasterTick& tick);
  void on(const SlaveTick& tick);
  void note(const std::string& what);
  void judge();
  void judge_following();

  Duration t() const { return loop_.now() - loop_.start(); }
  const Fault* active(FaultKind kind) const;

  Plan plan_;
  Scene scene_;
  Loopback loop_;
  Checkers checkers_;
  Watch watch_;
  Tracking tracking_;
  User user_;
  Attacker attacker_;
  Random random_;
  std::array<std::optional<KeyedChannel>, 2> channels_;
  std::optional<SecondMaster> second_master_;
  bool restarting_ = false;  // the master that was taken over from
  std::uint64_t sessions_ = 2;
  std::optional<Recorded> recorded_;

  Mode master_mode_ = Mode::disconnected, slave_shown_ = Mode::disconnected,
       slave_mode_ = Mode::disconnected;
  std::deque<std::string> events_;
  std::vector<const Fault*> active_;
  EpisodeResult result_;
};

Episode::Episode(const Plan& plan, const EpisodeOptions& options)
    : plan_(plan),
      scene_(scene_of(plan)),
      loop_(scene_, options_of(plan)),
      checkers_(loop_),
      watch_(loop_, checkers_, link_config(scene_, 1).max_late),
      tracking_(loop_, checkers_, limits_of(plan), wall_of(scene_)),
      user_(plan.seed ^ 0x75736572),
      attacker_(plan.seed ^ 0x6576696c, plan.secure),
      random_(plan.seed ^ 0x666c6970) {
  if (!options.faults) plan_.faults.clear();
  if (!options.record.empty())
    recorded_.emplace(options.record, scene_, options_of(plan), loop_.slave()->config());
  if (plan.secure) {
    start_channel(Side::master);
    start_channel(Side::slave);
    loop_.on_send = [this](Side from, auto d) {
      return channels_[static_cast<int>(from)]->seal(d);
    };
    loop_.on_arrival = [this](Side to, auto d) {
      return channels_[static_cast<int>(to)]->open(d, loop_.now());
    };
  }
  loop_.on_sent = [this](Side to, auto d) {
    attacker_.overhear(to, d);
    if (second_master_ && to == Side::master) second_master_->hear(d, loop_.now());
  };
  loop_.on_received = [this](Side, auto d, bool accepted) {
    watch_.received(attacker_.made(d), accepted);
  };
  loop_.on_reading = [this](HandleReading& r) { press(r); };
  loop_.on_robot = [this](RobotReading& r) {
    const Fault* spoilt = active(FaultKind::robot_spoilt);
    if (spoilt == nullptr || random_.uniform() >= spoilt->size) return;
    const std::array<Vec3*, 2> wrench = {&r.F_E_S.force, &r.F_E_S.torque};
    const auto what = random_.bits() % 4;
    if (what < 2) spoil(random_, what == 0 ? r.q : r.dq);
    if (what >= 2) spoil(random_, *wrench[what - 2]);
  };
  loop_.on_master = [this](const MasterTick& tick) { on(tick); };
  loop_.on_slave = [this](const SlaveTick& tick) { on(tick); };
}

const Fault* Episode::active(FaultKind kind) const {
  for (const Fault* f : active_)
    if (f->kind == kind) return f;
  return nullptr;
}

void Episode::note(const std::string& what) {
  constexpr std::size_t kKept = 60;
  events_.push_back(fmt::format("{:9.4f} s  {}", seconds(t()), what));
  if (events_.size() > kKept) events_.pop_front();
}

void Episode::start_channel(Side side) {
  channels_[static_cast<int>(side)].emplace(side == Side::master ? Role::master : Role::slave,
                                            random_.bits());
}

void Episode::start_process(Side side, Duration length) {
  loop_.restart(side, length, ++sessions_);
  checkers_.restarted(side);
  watch_.restarted(side, sessions_);
  if (plan_.secure) start_channel(side);
  (side == Side::master ? master_mode_ : slave_mode_) = Mode::disconnected;
}

void Episode::begin(const Fault& f) {
  note("fault: " + to_string(f));
  const Duration length = f.until - f.at;
  switch (f.kind) {
    case FaultKind::master_stall:
      return loop_.stall(Side::master, length);
    case FaultKind::slave_stall:
      return loop_.stall(Side::slave, length);
    case FaultKind::master_restart:
      return start_process(Side::master, length);
    case FaultKind::slave_restart:
      return start_process(Side::slave, length);
    case FaultKind::master_clock:
      watch_.clock_stepped();
      return loop_.step_clock(Side::master, from_seconds(f.size));
    case FaultKind::slave_clock:
      watch_.clock_stepped();
      return loop_.step_clock(Side::slave, from_seconds(f.size));
    case FaultKind::device_loss:
      loop_.unplug(Side::master, true);
      break;
    case FaultKind::robot_loss:
      loop_.unplug(Side::slave, true);
      break;
    case FaultKind::second_master:
      second_master_.emplace(++sessions_, scene_.shared_hash);
      break;
    default:
      break;
  }
  active_.push_back(&f);
}

void Episode::end(const Fault& f) {
  if (std::erase(active_, &f) == 0) return;
  note("over: " + to_string(f));
  loop_.unplug(Side::master, active(FaultKind::device_loss) != nullptr);
  loop_.unplug(Side::slave, active(FaultKind::robot_loss) != nullptr);
  if (f.kind == FaultKind::second_master) second_master_.reset();
}

EpisodeResult Episode::run() {
  std::vector<Duration> times;
  for (const Fault& f : plan_.faults) times.insert(times.end(), {f.at, f.until});
  for (Duration at{}; at < plan_.end; at += kTick) times.push_back(at);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  const proto::Link& link = scene_.proto.link();
  const auto to_slave = to_slave_config(link).value_or(ImpairmentConfig{.delay_ms = 0.05});
  const auto to_master = to_master_config(link).value_or(ImpairmentConfig{.delay_ms = 0.05});
  for (const Duration at : times) {
    loop_.run_until(loop_.start() + at);
    bool network = false;
    for (const Fault& f : plan_.faults) {
      network = network || (of_network(f.kind) && (f.at == at || f.until == at));
      if (f.until == at) end(f);
      if (f.at == at) begin(f);
    }
    if (network)
      loop_.change_network(network_at(plan_, kToSlave, to_slave, at),
                           network_at(plan_, kToMaster, to_master, at));
    act();
  }
  loop_.run_until(loop_.start() + plan_.end);
  judge();
  return std::move(result_);
}

// What others do, once in a while. A master that was taken over from ends, when it hears of it: its
// operator starts it again once the other is gone. One that was not gets in by itself.
void Episode::act() {
  const bool ended = loop_.master_end().taken_over() && !second_master_;
  if (ended && !restarting_) start_process(Side::master, kTick);
  restarting_ = ended;
  if (plan_.secure) handshake(Side::master);
  if (plan_.secure) handshake(Side::slave);
  if (second_master_) second_master_->tick(loop_);
  if (const Fault* f = active(FaultKind::replay)) attacker_.replay(loop_, f->size);
  if (const Fault* f = active(FaultKind::forgery)) attacker_.forge(loop_, f->size);
}

void Episode::handshake(Side side) {
  if (!loop_.up(side)) return;
  const auto frame = channels_[static_cast<int>(side)]->due(loop_.now());
  if (!frame.empty()) loop_.send(side == Side::master ? Side::slave : Side::master, frame);
}

void Episode::press(HandleReading& r) {
  watch_.sampling();
  tracking_.sampling();
  const User::Buttons b =
      t() < plan_.quiet ? user_.carelessly(t()) : user_.carefully(t(), master_mode_, slave_shown_);
  r.dead_man = r.ok && b.dead_man;
  r.clutch = r.ok && b.clutch;
  const Fault* spoilt = active(FaultKind::device_spoilt);
  if (spoilt == nullptr || random_.uniform() >= spoilt->size) return;
  const auto what = random_.bits() % 3;
  if (what == 0) spoil(random_, r.theta);
  if (what == 1) spoil(random_, r.ends.f_E1_M);
  if (what == 2) spoil(random_, r.ends.f_E2_A2);
}

void Episode::on(const MasterTick& tick) {
  checkers_.check(tick);
  watch_.check(tick);
  if (recorded_) recorded_->add(loop_, tick);
  if (tick.mode != master_mode_)
    note(fmt::format("master {} -> {}  {}", to_string(master_mode_), to_string(tick.mode),
                     to_string(tick.reason)));
  master_mode_ = tick.mode;
  slave_shown_ = tick.slave_mode;
  if (plan_.alignment_deg) loop_.turn_hand(user_.turn(t(), tick));
}

void Episode::on(const SlaveTick& tick) {
  checkers_.check(tick);
  watch_.check(tick);
  if (recorded_) recorded_->add(loop_, tick);
  if (tick.mode != slave_mode_)
    note(fmt::format("slave {} -> {}  {}", to_string(slave_mode_), to_string(tick.mode),
                     to_string(tick.reason)));
  if (t() < plan_.quiet) {
    result_.engaged += tick.mode == Mode::engaged;
    result_.engagements += tick.mode == Mode::engaged && slave_mode_ != Mode::engaged;
  }
  slave_mode_ = tick.mode;
  tracking_.check(tick, user_.engaged && t() >= *user_.engaged + kSettling);
}

void Episode::judge() {
  const Duration ready = user_.ready.value_or(plan_.end) - plan_.quiet;
  checkers_.expect(user_.ready && ready <= kMostToReady, "not READY after the faults, waited [s]",
                   seconds(ready), seconds(kMostToReady));
  checkers_.expect(user_.engaged.has_value(), "not ENGAGED when pressed after the faults", 0, 0);
  const bool on = master_mode_ == Mode::engaged && slave_mode_ == Mode::engaged;
  checkers_.expect(on, "not ENGAGED at the end", static_cast<double>(master_mode_),
                   static_cast<double>(slave_mode_));
  judge_following();
  result_.violations = checkers_.count();
  result_.first_violations = checkers_.first();
  result_.last_events.assign(events_.begin(), events_.end());
  result_.ready_after = ready;
  result_.oldest_command = watch_.oldest_command();
  result_.lag = tracking_.lag();
  result_.command = tracking_.command();
  result_.tool = tracking_.tool();
  if (recorded_) recorded_->end();
}

// While the hand asks for what is clear of the wall, the tool follows, or a limit holds it back.
void Episode::judge_following() {
  constexpr double kTicks = 0.98;
  const auto free = static_cast<double>(tracking_.free());
  const auto seen = static_cast<double>(tracking_.judged() + tracking_.limited());
  checkers_.expect(seen >= kTicks * free, "the tool was free and not seen to follow, in ticks",
                   seen, free);
  result_.limited = tracking_.limited();
}

}  // namespace

EpisodeResult run_episode(const Plan& plan, const EpisodeOptions& options) {
  return Episode(plan, options).run();
}

}  // namespace farhand
