// farhand-tick-cost SCENE PART FROM COUNT: replays the ticks of a scene's virtual run and has
// callgrind (started with --instr-atstart=no) count the instructions of COUNT of them from number
// FROM on. PART:
//
//   master, slave                    the product's ticks alone: no link, no device, no plant
//   straight-master, straight-slave  the smallest scene's, see straight_ticks.hpp
//   bare-master, bare-slave          the same without leaving a record
//   recorded-master, recorded-slave  the product's, each handed to the recorder's thread
//   check                            counts nothing; fails unless straight and product give the
//                                    same bits
//
// Exit status 77, with the reason, where counting would say nothing.
#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/program.hpp"
#include "master/build.hpp"
#include "slave/build.hpp"
#include "tests/loop/recorded_ticks.hpp"
#include "tests/loop/straight_ticks.hpp"

namespace farhand {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FARHAND_NO_COUNT "this build is sanitised"
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FARHAND_NO_COUNT "this build is sanitised"
#endif
#endif
#if !defined(FARHAND_NO_COUNT) && !defined(__OPTIMIZE__)
#define FARHAND_NO_COUNT "this build is not optimised"
#endif

template <typename Input, typename Tick>
void count(const std::vector<Input>& inputs, std::size_t from, std::size_t ticks, Tick&& tick) {
  if (inputs.size() < from + ticks) throw std::runtime_error("the scene ends before these ticks");
  for (std::size_t i = 0; i < from; ++i) tick(inputs[i]);
  CALLGRIND_START_INSTRUMENTATION;
  for (std::size_t i = from; i < from + ticks; ++i) tick(inputs[i]);
  CALLGRIND_STOP_INSTRUMENTATION;
}

bool same(const MasterTick& a, const MasterTick& b) {
  const auto bits = [](const MasterTick& t) {
    return (Eigen::Matrix<double, 31, 1>() << t.out.p_MH, t.out.q_MH.coeffs(), t.out.V_MH.linear,
            t.out.V_MH.angular, t.reading.theta, t.handle.X_MH.p, t.handle.R_MG.reshaped())
        .finished();
  };
  return bits(a) == bits(b) && a.out.mode == b.out.mode && a.mode == b.mode &&
         a.out.dead_man_presses == b.out.dead_man_presses && a.age == b.age &&
         a.slave_mode == b.slave_mode && a.reason == b.reason && a.slave_reason == b.slave_reason &&
         a.coupled == b.coupled;
}

bool same(const SlaveTick& a, const SlaveTick& b) {
  const auto bits = [](const SlaveTick& t) {
    return (Eigen::Matrix<double, 37, 1>() << t.out.p_SE, t.out.q_SE.coeffs(), t.out.V_SE.linear,
            t.out.V_SE.angular, t.q_cmd, t.tau, t.robot.q, t.X_SE.p, t.X_SE_target.p)
        .finished();
  };
  return bits(a) == bits(b) && a.out.mode == b.out.mode && a.mode == b.mode &&
         a.reason == b.reason && a.out.coupled == b.out.coupled && a.limits == b.limits &&
         a.inverse == b.inverse;
}

bool same_bits(const MasterConfig& m, const SlaveConfig& s, const RecordedTicks& recorded) {
  Master master(m);
  StraightMaster<true> straight_master(m);
  bool equal = true;
  for (const MasterInput& i : recorded.master) {
    master.sample(i.now, i.reading, fresh(i.in));
    equal &= same(master.actuate(i.now, fresh(i.in)),
                  straight_master.tick(i.now, i.reading, fresh(i.in)));
  }
  Slave slave(s);
  StraightSlave<true> straight_slave(s);
  std::size_t coupled = 0;
  for (const SlaveInput& i : recorded.slave) {
    const SlaveTick& t = slave.tick(i.now, fresh(i.in), i.robot);
    equal &= same(t, straight_slave.tick(i.now, fresh(i.in), i.robot));
    coupled += t.coupled ? 1 : 0;
  }
  return equal && coupled > 0;
}

// What the loops do with a tick, without the thread at the other end.
template <typename Record>
class HandOver {
 public:
  template <typename Tick>
  void add(const Tick& tick) {
    queue_.slot()->tick = tick;
    queue_.commit();
    queue_.front();
    queue_.pop();
  }

 private:
  SpscQueue<Record> queue_{16};
};

int run(const std::string& part, const Scene& scene, std::size_t from, std::size_t ticks) {
  const RecordedTicks recorded = record_ticks(scene, from + ticks);
  const MasterConfig m = master_config(scene.proto);
  const SlaveConfig s = slave_config(scene.proto);
  const auto master_line = [&](auto side) {
    count(recorded.master, from, ticks,
          [&](const MasterInput& i) { side.tick(i.now, i.reading, fresh(i.in)); });
  };
  const auto slave_line = [&](auto side) {
    count(recorded.slave, from, ticks,
          [&](const SlaveInput& i) { side.tick(i.now, fresh(i.in), i.robot); });
  };
  if (part == "recorded-master") {
    Master master(m);
    HandOver<MasterRecord> queue;
    count(recorded.master, from, ticks, [&](const MasterInput& i) {
      master.sample(i.now, i.reading, fresh(i.in));
      queue.add(master.actuate(i.now, fresh(i.in)));
    });
  } else if (part == "recorded-slave") {
    Slave slave(s);
    HandOver<SlaveRecord> queue;
    count(recorded.slave, from, ticks,
          [&](const SlaveInput& i) { queue.add(slave.tick(i.now, fresh(i.in), i.robot)); });
  } else if (part == "master") {
    Master master(m);
    count(recorded.master, from, ticks, [&](const MasterInput& i) {
      master.sample(i.now, i.reading, fresh(i.in));
      master.actuate(i.now, fresh(i.in));
    });
  } else if (part == "slave") {
    slave_line(Slave(s));
  } else if (part == "straight-master") {
    master_line(StraightMaster<true>(m));
  } else if (part == "straight-slave") {
    slave_line(StraightSlave<true>(s));
  } else if (part == "bare-master") {
    master_line(StraightMaster<false>(m));
  } else if (part == "bare-slave") {
    slave_line(StraightSlave<false>(s));
  } else if (part != "check") {
    std::printf("no such part: %s\n", part.c_str());
    return 2;
  } else if (!same_bits(m, s, recorded)) {
    std::puts("the straight ticks do not do the product's work");
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace farhand

int main(int argc, char** argv) {
  using namespace farhand;
#ifdef FARHAND_NO_COUNT
  std::puts("skipped: " FARHAND_NO_COUNT);
  return 77;
#endif
  if (argc != 5) {
    std::puts("usage: farhand-tick-cost SCENE PART FROM COUNT");
    return 2;
  }
  return run_guarded("farhand-tick-cost", [&] {
    return run(argv[2], load_scene(argv[1]), std::strtoul(argv[3], nullptr, 10),
               std::strtoul(argv[4], nullptr, 10));
  });
}
