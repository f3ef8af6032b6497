#include "common/joint_continuity.hpp"

#include <algorithm>

namespace farhand {

JointContinuity::Verdict JointContinuity::judge(TimePoint now, const Vec6& q) noexcept {
  if (!q.allFinite()) return Verdict::leapt;
  const bool leapt = seen_ && leaps(read_, now, q);
  const bool doubted = seen_ && !certain_;
  if (leapt && !doubted) believed_ = read_;
  const bool elsewhere = doubted && !leapt && leaps(believed_, now, q);
  seen_ = true;
  certain_ = !leapt;
  read_ = {q, now};
  if (leapt) return Verdict::leapt;
  return elsewhere ? Verdict::elsewhere : Verdict::continues;
}

bool JointContinuity::leaps(const Place& from, TimePoint now, const Vec6& q) const noexcept {
  constexpr Duration kGap = std::chrono::milliseconds(50);
  const double since = seconds(std::clamp(now - from.at, Duration::zero(), kGap));
  const Vec6 way = 2 * since * speed_ + Vec6::Constant(kLeap);
  return ((q - from.q).cwiseAbs() - way).maxCoeff() > 0;
}

}  // namespace farhand
