// A master's tick with what it needs around it.
#pragma once

#include "master/master.hpp"

namespace farhand {

// A handle held still at home by a hand that is not there, and a slave whose answer is always the
// one set here.
struct MasterRig {
  explicit MasterRig(MasterConfig config = default_config()) : master(config) {
    reading.theta = motor_angles(kTwinDelta, {}).theta1;
  }

  static MasterConfig default_config() {
    MasterConfig c;
    c.handle = TwinDeltaHandle{};
    c.force_feedback.emplace();
    c.force_feedback->controller.limits = {
        .force = 20, .torque = 1, .twist_torque = 0.15, .force_step = 0.5, .torque_step = 0.025};
    return c;
  }

  const MasterTick& tick(int times = 1) {
    const MasterTick* t = nullptr;
    for (int i = 0; i < times; ++i) {
      now += std::chrono::milliseconds(1);
      const Peer<SlaveToMaster> slave{
          .newest = &answer, .connected = connected, .age = age, .synced = true};
      sent = master.sample(now, reading, slave);
      t = &master.actuate(now, slave);
      answer.coupled = sent.mode == Mode::engaged;
      if (hears) answer.clutch_presses_seen = sent.clutch_presses;
    }
    return *t;
  }
  void engage() {
    reading.dead_man = false;
    answer.mode = Mode::ready;
    tick(2);
    reading.dead_man = true;
    tick();
    answer.mode = Mode::engaged;
  }

  Master master;
  HandleReading reading{.ok = true};
  SlaveToMaster answer;
  MasterToSlave sent;
  bool hears = true;  // the slave, of presses
  bool connected = true;
  Duration age{};
  TimePoint now{};
};

}  // namespace farhand
