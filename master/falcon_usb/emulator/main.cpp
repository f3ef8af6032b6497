// farhand-falcon-emulator: runs a command with a Falcon on its USB that is not there.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <stdexcept>

#include "common/arguments.hpp"
#include "common/program.hpp"
#include "common/realtime.hpp"
#include "master/build_falcon.hpp"
#include "master/falcon_usb/emulator/command_pipe.hpp"
#include "master/falcon_usb/emulator/mock_bus.hpp"
#include "master/falcon_usb/emulator/mocked_child.hpp"
#include "master/falcon_usb/emulator/scripted_hand.hpp"

namespace farhand::falcon_usb {
namespace {

struct Options {
  bool firmware_loaded = false, homed = false, no_power = false;
  bool permission_denied = false, busy = false;
  std::string serial = "FH0042", motion = "still";
  std::optional<std::string> hand, scene;
  std::optional<std::uint64_t> seed;
  double unplug_after_s = 0, replug_after_s = 0;  // 0: never
  SerialFaults serial_faults;
  BusFaults bus_faults;
  std::vector<std::string> command;
};

void add_faults(Arguments& arguments, Options& o) {
  SerialFaults& serial = o.serial_faults;
  BusFaults& bus = o.bus_faults;
  const auto ratio = [&](const char* name, double& to, const char* help) {
    arguments.number(name, to, {.least = 0, .most = 1}, help);
  };
  ratio("--echo-wrong", serial.echo_wrong, "of bytes of firmware: the echo is another");
  ratio("--lost", serial.lost, "of answers: it does not come");
  ratio("--duplicated", serial.duplicated, "it comes twice");
  ratio("--garbage", serial.garbage, "up to 20 other bytes come before it");
  ratio("--cut", serial.cut, "one byte of it is missing");
  ratio("--altered", serial.altered, "one letter of it is another");
  ratio("--delayed", serial.delayed, "it comes up to 4 ms late");
  ratio("--split", bus.split, "of packets on the bus: it carries only a part");
  ratio("--held", bus.held, "it carries nothing, the next one twice as much");
  ratio("--failed", bus.failed, "of requests on the bus: it fails");
  ratio("--hung", bus.hung, "it hangs for 5 ms, then it fails");
}

HandMotion hand_motion(const std::string& word) {
  if (word == "none") return HandMotion::none;
  if (word == "still") return HandMotion::still;
  if (word == "circle") return HandMotion::circle;
  throw std::runtime_error("--motion is '" + word + "'; it can be none, still or circle");
}

// What the device is in truth, whatever its driver takes it to be.
EmulatedHandConfig device_config(const Options& o) {
  if (!o.scene) return {};
  const Scene scene = load_scene(*o.scene);
  if (!scene.proto.master().has_falcon())
    throw std::runtime_error(*o.scene + " has no falcon as its master's handle");
  const DriverConfig c = falcon_usb_config(scene).driver;
  return {.geometry = c.geometry, .counts_per_newton_meter = c.counts_per_newton_meter};
}

void check(const Options& o) {
  if (o.replug_after_s > 0 && o.unplug_after_s == 0)
    throw std::runtime_error("--replug-after without --unplug-after: it would be plugged in twice");
  if (o.homed && !o.firmware_loaded)
    throw std::runtime_error("--homed without --firmware-loaded: it is firmware that homes");
}

EmulatorConfig emulator_config(const Options& o) {
  return {
      .processor = {.firmware_loaded = o.firmware_loaded,
                    .homed = o.homed,
                    .faults = o.serial_faults},
      .faults = o.bus_faults,
      .seed = o.seed.value_or(1),
  };
}

// Root may open anything: then it is nobody who runs it.
std::vector<std::string> command(const Options& o) {
  if (!o.permission_denied || geteuid() != 0) return o.command;
  std::vector<std::string> out{"setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups",
                               "--"};
  out.insert(out.end(), o.command.begin(), o.command.end());
  return out;
}

// Plugs and unplugs while the command runs, and passes on what the hand is told.
class Bench {
 public:
  explicit Bench(const Options& o)
      : options_(o),
        hand_(hand_motion(o.motion), device_config(o)),
        bus_({.emulator = emulator_config(o),
              .mechanism = hand_.mechanism(),
              .clock = monotonic_now,
              .serial = o.serial,
              .real_time = true}) {
    if (o.hand) told_.emplace(*o.hand);
    if (o.no_power) bus_.cut_power();
    bus_.occupy(o.busy);
    plug();
  }

  int run() {
    MockedChild child(command(options_));
    const TimePoint begin = monotonic_now();
    bool told = false;
    for (;; sleep_until(monotonic_now() + std::chrono::milliseconds(5))) {
      if (const auto status = child.status()) return *status;
      if (stop_requested() && !std::exchange(told, true)) child.terminate();
      look(seconds(monotonic_now() - begin));
      pass_on();
    }
  }

 private:
  void look(double t) {
    const double out = options_.unplug_after_s, in = out + options_.replug_after_s;
    if (out > 0 && t >= out && times_ == 0) unplug();
    if (in > out && t >= in && times_ == 1) plug_again();
  }
  void pass_on() {
    if (!told_) return;
    if (hand_.arrived()) spdlog::info("hand: there");
    const auto line = told_->line();
    if (!line || line->empty()) return;
    try {
      hand_.tell(*line);
      spdlog::info("hand: {}", *line);
    } catch (const std::exception& e) {
      spdlog::warn("{}", e.what());
    }
  }
  void unplug() {
    ++times_;
    bus_.unplug();
    spdlog::info("unplugged");
  }
  // Nobody asks the hand before it is plugged in.
  void plug_again() {
    ++times_;
    hand_.begin_again();
    plug();
    spdlog::info("plugged in again");
  }
  void plug() {
    bus_.plug();
    if (options_.permission_denied) bus_.forbid();
  }

  const Options& options_;
  ScriptedHand hand_;
  MockBus bus_;
  std::optional<CommandPipe> told_;
  int times_ = 0;  // unplugged and plugged in again
};

}  // namespace
}  // namespace farhand::falcon_usb

int main(int argc, char** argv) {
  using namespace farhand;
  falcon_usb::Options o;
  Arguments arguments(
      "Runs a command with a Falcon on its USB that is not there, and a hand that homes it, arms "
      "it "
      "and moves it",
      "farhand-falcon-emulator");
  arguments.flag("--firmware-loaded", o.firmware_loaded, "its firmware runs already");
  arguments.flag("--homed", o.homed, "it has been homed before");
  arguments.option("--serial", o.serial, "serial number");
  arguments.flag("--no-power", o.no_power, "its power supply is not plugged in");
  arguments.flag("--permission-denied", o.permission_denied, "this user may not open it");
  arguments.flag("--busy", o.busy, "another program has it");
  arguments.option("--motion", o.motion,
                   "of the hand: still or circle once it has armed the device, or none at all");
  arguments.option("--hand", o.hand,
                   "a pipe to make: what is written into it the hand does, such as press centre");
  arguments.option("--like", o.scene, "the device has geometry and force of this scene's falcon");
  arguments.option("--seed", o.seed, "of the faults");
  const NumberRange time{.least = 0.001, .most = 1e7, .of = "seconds"};
  arguments.number("--unplug-after", o.unplug_after_s, time, "so long after the command began");
  arguments.number("--replug-after", o.replug_after_s, time, "so long after that");
  falcon_usb::add_faults(arguments, o);
  arguments.option("command", o.command, "and its arguments, after --");
  const auto missing = [&] { return o.command.empty() ? "a command after --" : ""; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  catch_stop_signals();
  return run_guarded("farhand-falcon-emulator", [&] {
    falcon_usb::check(o);
    falcon_usb::mock_this_process(argv);
    return falcon_usb::Bench(o).run();
  });
}
