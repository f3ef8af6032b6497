// A slave's tick with what it needs around it.
#pragma once

#include "slave/slave.hpp"

namespace farhand {

// A robot that is where it was told to be, and a master whose message is always the one set here.
struct SlaveRig {
  explicit SlaveRig(SlaveConfig config = default_config()) : slave(config) {
    robot.q = kTeleopHome;
  }

  static SlaveConfig default_config() {
    SlaveConfig c;
    c.workspace.R_SM = twin_delta_axes();
    c.servo.gravity_compensation = true;
    return c;
  }

  const SlaveTick& tick(int times = 1) {
    const SlaveTick* t = nullptr;
    for (int i = 0; i < times; ++i) {
      now += std::chrono::milliseconds(1);
      t = &slave.tick(now, {.newest = &message, .connected = connected, .age = age, .synced = true},
                      robot);
      robot.q = t->q_cmd;
    }
    return *t;
  }
  void press() {
    message.dead_man = true;
    message.mode = Mode::engaged;
  }
  void release() {
    message.dead_man = false;
    message.mode = Mode::ready;
  }
  void engage() {
    release();
    tick(2);
    press();
    tick();
  }

  Slave slave;
  RobotReading robot{.ok = true};
  MasterToSlave message{.p_MH = Vec3(0.18, 0, 0)};
  bool connected = true;
  Duration age{};
  TimePoint now{};
};

}  // namespace farhand
