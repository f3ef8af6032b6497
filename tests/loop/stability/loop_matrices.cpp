#include "tests/loop/stability/loop_matrices.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace farhand {
namespace {

using Complex = std::complex<double>;
constexpr double kTurn = 2 * std::numbers::pi;

// Calls f on every number of a state, in one order.
template <typename State, typename F>
void each(State& s, F f) {
  for (auto* x : {&s.x, &s.v, &s.F_u, &s.motor, &s.filtered, &s.I, &s.e, &s.D, &s.command,
                  &s.command_rate, &s.sensed})
    f(*x);
  for (auto* joints : {&s.q, &s.dq, &s.servo_I, &s.servo_D, &s.last_q})
    for (auto& x : *joints) f(x);
  for (auto& x : s.answers) f(x);
  if (!s.device) return;
  auto& d = *s.device;
  for (auto* x : {&d.x, &d.off_model, &d.v, &d.rest, &d.off_pose, &d.v_pose, &d.a, &d.disturbance})
    f(*x);
  for (auto& x : d.given) f(x);
}

Eigen::Index count(const AxisState& s) {
  Eigen::Index n = 0;
  each(s, [&](double) { ++n; });
  return n;
}

Eigen::VectorXd flat(const AxisState& s) {
  Eigen::VectorXd z(count(s));
  Eigen::Index i = 0;
  each(s, [&](double x) { z[i++] = x; });
  return z;
}

// c (z - A)^-1 b over many z: A is brought to Hessenberg form once, so that each z costs n^2.
class Response {
 public:
  explicit Response(const LoopMatrices& loop) {
    const Eigen::HessenbergDecomposition<Eigen::MatrixXd> form(loop.A);
    const Eigen::MatrixXd Q = form.matrixQ();
    H_ = form.matrixH();
    b_ = Q.transpose() * loop.b;
    c_ = loop.c * Q;
  }

  Complex at(Complex z) const {
    const Eigen::Index n = H_.rows();
    Eigen::MatrixXcd U = (-H_).cast<Complex>();
    U.diagonal().array() += z;
    Eigen::VectorXcd x = b_.cast<Complex>();
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      if (std::abs(U(i + 1, i)) > std::abs(U(i, i))) {
        U.row(i).tail(n - i).swap(U.row(i + 1).tail(n - i));
        std::swap(x[i], x[i + 1]);
      }
      const Complex share = U(i + 1, i) / U(i, i);
      U.row(i + 1).tail(n - i) -= share * U.row(i).tail(n - i);
      x[i + 1] -= share * x[i];
    }
    return c_.cast<Complex>() * U.triangularView<Eigen::Upper>().solve(x);
  }

 private:
  Eigen::MatrixXd H_;
  Eigen::VectorXd b_;
  Eigen::RowVectorXd c_;
};

// Where the straight line from f0 at x0 to f1 at x1 is zero.
double zero(double x0, double f0, double x1, double f1) {
  return x0 + (x1 - x0) * f0 / (f0 - f1);
}

// G is what comes round, so the loop is at its limit where G = 1.
void between(double w0, Complex G0, double w1, Complex G1, double Ts, Margins& out) {
  if (std::imag(G0) * std::imag(G1) <= 0 && std::imag(G0) != std::imag(G1)) {
    const double w = zero(w0, std::imag(G0), w1, std::imag(G1));
    const double real = std::real(G0) + (w - w0) / (w1 - w0) * std::real(G1 - G0);
    if (real > 0 && real < 1 && 1 / real < out.gain)
      out.gain = 1 / real, out.gain_at_hz = w / kTurn;
  }
  const double over0 = std::log(std::abs(G0)), over1 = std::log(std::abs(G1));
  if (over0 * over1 > 0 || over0 == over1) return;
  const double w = zero(w0, over0, w1, over1);
  const double angle = std::arg(std::abs(w - w0) < std::abs(w - w1) ? G0 : G1);
  if (std::abs(angle) < out.phase) out.phase = std::abs(angle), out.phase_at_hz = w / kTurn;
  if (w < 0.99 * std::numbers::pi / Ts)
    out.delay = std::min(out.delay, (angle < 0 ? angle + kTurn : angle) / w);
}

}  // namespace

LoopMatrices loop_matrices(const AxisPeriod& period) {
  const AxisState rest = period.rest();
  const Eigen::Index n = count(rest);
  LoopMatrices out{Eigen::MatrixXd(n, n), Eigen::VectorXd(n), Eigen::RowVectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    AxisState s = rest;
    Eigen::Index at = 0;
    each(s, [&](double& x) { x = at++ == i ? 1 : 0; });
    out.c[i] = period.run(s, 0.0);
    out.A.col(i) = flat(s);
  }
  AxisState pushed = rest;
  period.run(pushed, 1.0);
  out.b = flat(pushed);
  return out;
}

std::vector<Pole> poles(const Eigen::MatrixXd& A, double Ts) {
  const Eigen::VectorXcd z = A.eigenvalues();
  std::vector<Pole> out;
  for (const Complex& each_z : z) {
    const Complex s = std::log(each_z) / Ts;
    const double w = std::abs(s);
    out.push_back({each_z, w / kTurn, w > 0 ? -std::real(s) / w : 1});
  }
  std::sort(out.begin(), out.end(),
            [](const Pole& a, const Pole& b) { return std::abs(a.z) > std::abs(b.z); });
  return out;
}

double spectral_radius(const Eigen::MatrixXd& A) {
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

Margins margins(const LoopMatrices& loop, double Ts) {
  constexpr int kPoints = 800;
  constexpr double kLowestHz = 0.02;
  Margins out;
  const Response response(loop);
  const double top = std::numbers::pi / Ts, bottom = kTurn * kLowestHz;
  double w0 = 0;
  Complex G0;
  for (int i = 0; i <= kPoints; ++i) {
    const double w = i == kPoints ? top : bottom * std::pow(top / bottom, double(i) / kPoints);
    Complex G = response.at(std::exp(Complex(0, w * Ts)));
    if (i == kPoints) G = std::real(G);  // at half the rate it is, but for rounding
    if (i > 0) between(w0, G0, w, G, Ts, out);
    w0 = w, G0 = G;
  }
  return out;
}

}  // namespace farhand
