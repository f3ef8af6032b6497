// The period of an axis as matrices, the loop opened where the motors are commanded, and what they
// say of stability.
//
//   z(k+1) = A z(k) + b u(k),  the controller asks for c z(k);  closed: u = c z, so A + b c
#pragma once

#include <complex>
#include <vector>

#include "tests/loop/stability/axis_period.hpp"

namespace farhand {

struct LoopMatrices {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  Eigen::RowVectorXd c;

  Eigen::MatrixXd closed() const { return A + b * c; }
};

LoopMatrices loop_matrices(const AxisPeriod& period);

struct Pole {
  std::complex<double> z;
  double frequency_hz = 0;   // of ln(z) / Ts
  double damping_ratio = 0;  // below 0: grows
};

// Largest first.
std::vector<Pole> poles(const Eigen::MatrixXd& A, double Ts);
double spectral_radius(const Eigen::MatrixXd& A);

// Of the loop with everything else closed, from the motor command round to it. Without a crossing
// nothing limits: infinity.
struct Margins {
  double gain = std::numeric_limits<double>::infinity();  // factor by which all of it may grow
  double gain_at_hz = 0;
  double phase = std::numeric_limits<double>::infinity();  // [rad]
  double phase_at_hz = 0;
  double delay = std::numeric_limits<double>::infinity();  // [s] more that it would bear
};
Margins margins(const LoopMatrices& loop, double Ts);

}  // namespace farhand
