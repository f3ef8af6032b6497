// The arm as a KDL chain, from its DH table alone.
#pragma once

#include <kdl/chain.hpp>
#include <numbers>

#include "slave/arm.hpp"

namespace farhand {

inline KDL::Chain kdl_chain(const ArmGeometry& g) {
  const double quarter = std::numbers::pi / 2;
  const double a[6] = {0, g.a2, 0, 0, 0, 0}, d[6] = {g.d1, 0, 0, g.d4, 0, g.d6};
  const double alpha[6] = {quarter, 0, quarter, -quarter, quarter, 0};
  KDL::Chain chain;
  for (int i = 0; i < 6; ++i)
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(a[i], alpha[i], d[i], 0)));
  return chain;
}

}  // namespace farhand
