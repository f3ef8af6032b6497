// What the simulated operator's hand wants to do: sines, reaches and a recorded trace, added up.
//
//   sine    amplitude sin(2 pi f (t - from)) min(1, t - from), the corner of the minimum rounded
//           over 0.2 s, and faded to rest within the last second before `until`
//   reach   10 s^3 - 15 s^4 + 6 s^5 of the offset, s = (t - at) / lasting; the offset stays
//
// The sum is continuous in position and velocity. Sines and reaches that could exceed a speed limit
// are refused at the start; a trace is slowed down to what the others leave of it.
#pragma once

#include <optional>
#include <vector>

#include "master/trace.hpp"

namespace farhand {

struct Sine {
  double from = 0;             // [s]
  double until = 86400;        // [s]
  double frequency = 1;        // [Hz] > 0
  Vec3 offset = Vec3::Zero();  // amplitudes [m], along the axes of M
  Vec3 turn = Vec3::Zero();    // amplitudes [rad], tilt about x, about y, twist
};

struct Reach {
  double at = 0;             // [s]
  double lasting = 1;        // [s] > 0
  Vec3 by = Vec3::Zero();    // [m]
  Vec3 turn = Vec3::Zero();  // [rad]
};

struct MotionConfig {
  std::vector<Sine> sines{};
  std::vector<Reach> reaches{};
  std::optional<TraceConfig> trace{};
  SpeedLimits limits{};
};

class Motion {
 public:
  // Reads the trace's file. Throws std::runtime_error with a sentence on a bad file, on a wish that
  // could exceed its limits, and on one that leaves a trace less than a tenth of them.
  explicit Motion(MotionConfig config = {});

  // t in seconds; before 0 as at 0. Constant effort per sine, logarithmic in the reaches.
  MotionSample at(double t) const noexcept;

  const std::optional<Trace>& trace() const noexcept { return trace_; }

 private:
  // Sum of all reaches up to this one in order of start, and when the last of them ends.
  struct Done {
    Vec6 offset;
    double end;
  };
  void add_reaches(double t, Vec6& x, Vec6& rate) const noexcept;

  MotionConfig config_;
  std::vector<Done> done_;
  std::optional<Trace> trace_;
};

}  // namespace farhand
