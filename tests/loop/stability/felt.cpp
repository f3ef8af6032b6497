#include "tests/loop/stability/felt.hpp"

#include <limits>
#include <stdexcept>

#include "tests/loop/loopback.hpp"
#include "tests/loop/stability/simulated.hpp"

namespace farhand {

FeltStiffness felt_stiffness(const AxisModel& m) {
  Mat6 K = m.arm.servo.gravity_compensation ? Mat6(Mat6::Zero()) : m.arm.K_g;
  for (int i = 0; i < 6; ++i)
    K(i, i) +=
        joint_gains(m.arm.servo, m.arm.servo.inertia[i], std::numeric_limits<double>::infinity())
            .kp;
  const double servo = 1 / m.arm.g.dot(K.partialPivLu().solve(m.arm.g));
  const double both = 1 / (1 / m.wall.stiffness + 1 / servo);
  return {.wall = m.wall.stiffness, .servo = servo, .felt = m.scale * m.force_scale * both};
}

double measured_felt_stiffness(const Scene& scene, int surface) {
  constexpr double kTravel = 0.002, kRest = 1e-5;  // [m], [m/s]
  constexpr double kEnd = 8;                       // [s]
  const AxisModel m = axis_model(scene, surface);
  Scene pushed = linear_scene(scene, surface);
  pushed.proto.mutable_slave()->mutable_joint_pid()->set_integral_per_s(0);
  proto::SimHand& hand = *pushed.proto.mutable_master()->mutable_sim_hand();
  const double begin = hand.push(0).at_s();
  hand.clear_push();
  proto::Reach& reach = *hand.mutable_operator_()->mutable_motion()->add_reach();
  reach.set_at_s(begin);
  reach.set_lasting_s(1);
  for (double by : kTravel* m.axis_M) reach.add_by_m(by);

  double travel = 0, force = 0, speed = 0;
  Loopback loop(pushed, {.duration_s = begin + kEnd});
  loop.on_master = [&](const MasterTick& t) {
    const Vec3 start = loop.slave()->workspace().p_MH0;
    travel = m.axis_M.dot(t.handle.X_MH.p - start);
    force = -m.axis_M.dot(t.handle.R_MG * t.F_G.force);
    speed = t.out.V_MH.linear.norm();
  };
  loop.run();
  if (!(speed < kRest))
    throw std::runtime_error(scene.path +
                             ": the handle does not come to rest at the wall, so there "
                             "is no stiffness to be measured");
  return force / travel;
}

}  // namespace farhand
