// The arm in MuJoCo, which forms kinematics and dynamics independently. The MJCF is written from
// our own parameters, so that no constant has a second home.
#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "slave/arm_dynamics.hpp"

namespace farhand {

struct MujocoArm {
  explicit MujocoArm(const ArmModel& arm) {
    const std::string xml = mjcf(arm);
    auto vfs = std::make_unique<mjVFS>();
    mj_defaultVFS(vfs.get());
    mj_makeEmptyFileVFS(vfs.get(), "arm.xml", static_cast<int>(xml.size()));
    std::memcpy(vfs->filedata[0], xml.data(), xml.size());
    char error[1000] = "";
    model.reset(mj_loadXML("arm.xml", vfs.get(), error, sizeof error));
    mj_deleteVFS(vfs.get());
    if (!model) throw std::runtime_error(error);
    data.reset(mj_makeData(model.get()));
  }

  static std::string mjcf(const ArmModel& arm) {
    std::ostringstream out;
    out.precision(17);
    const Eigen::IOFormat row(17, Eigen::DontAlignCols, " ", " ");
    out << "<mujoco><compiler angle='radian'/><option gravity='"
        << arm.gravity.transpose().format(row) << "'/><worldbody>";
    const Vec3 offset[] = {{0, 0, 0}, {0, 0, arm.lengths.d1}, {arm.lengths.a2, 0, 0},
                           {0, 0, 0}, {0, 0, arm.lengths.d4}, {0, 0, 0}};
    const int turn[] = {0, 1, 0, 1, -1, 1};
    for (int i = 0; i < 6; ++i) {
      const LinkModel& l = arm.links[static_cast<std::size_t>(i)];
      out << "<body pos='" << offset[i].transpose().format(row) << "' quat='"
          << (turn[i] == 0 ? 1 : std::numbers::sqrt2 / 2) << ' '
          << turn[i] * std::numbers::sqrt2 / 2 << " 0 0'><inertial pos='"
          << l.com.transpose().format(row) << "' mass='" << l.mass << "' diaginertia='"
          << l.inertia.transpose().format(row) << "'/><joint axis='0 0 1' armature='"
          << arm.armature << "'/>";
    }
    out << "<site name='E' pos='0 0 " << arm.lengths.d6 << "'/>";
    for (int i = 0; i < 6; ++i) out << "</body>";
    out << "</worldbody></mujoco>";
    return out.str();
  }

  Vec6 accelerations(const Vec6& q, const Vec6& dq, const Vec6& tau, const Wrench& F_E_S) const {
    Vec6::Map(data->qpos) = q;
    Vec6::Map(data->qvel) = dq;
    Vec6::Map(data->qfrc_applied) = tau;
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    const Vec3 arm = Vec3::Map(data->site_xpos) - Vec3::Map(data->xipos + 3 * 6);
    Vec3::Map(data->xfrc_applied + 6 * 6) = F_E_S.force;  // acts at the last link's COM
    Vec3::Map(data->xfrc_applied + 6 * 6 + 3) = F_E_S.torque + arm.cross(F_E_S.force);
    mj_forward(model.get(), data.get());
    return Vec6::Map(data->qacc);
  }

  Mat6 mass_matrix() const {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> M;
    mj_fullM(model.get(), M.data(), data->qM);
    return M;
  }

  struct Free {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  std::unique_ptr<mjModel, Free> model;
  std::unique_ptr<mjData, Free> data;
};

}  // namespace farhand
