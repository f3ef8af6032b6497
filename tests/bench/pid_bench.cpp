// PID and one-pole filter over very many ticks: rounding against long double, and cost.
#include <algorithm>
#include <array>
#include <cstdint>

#include "common/pid.hpp"
#include "tests/bench/bench_table.hpp"

namespace farhand::bench {
namespace {

constexpr double kTs = 0.001;
constexpr PidConfig kGains{.kp = 150, .ki = 13, .kd = 5};
constexpr double kCutoff = 10;  // [Hz]
constexpr std::size_t kTimed = 4096;
constexpr std::uint64_t kWindow = 100;  // ticks before a count of ticks whose worst error counts

// A triangle of 5 s with noise, of mean zero.
class Signal {
 public:
  double next() {
    random_ ^= random_ << 13, random_ ^= random_ >> 7, random_ ^= random_ << 17;
    const double noise = static_cast<double>(random_ >> 11) * 0x1p-53 - 0.5;
    constexpr int kPeriod = 5000;
    tick_ = tick_ + 1 == kPeriod ? 0 : tick_ + 1;
    const int up = tick_ < kPeriod / 2 ? tick_ : kPeriod - tick_;
    return 0.05 * (4.0 * up / kPeriod - 1) + 0.002 * noise;
  }

 private:
  std::uint64_t random_ = 88172645463325252u;
  int tick_ = 0;
};

// A sum that remembers what rounding took from it (Kahan).
template <typename T>
struct Compensated {
  T sum = 0, lost = 0;
  void add(T x) {
    const T y = x - lost, t = sum + y;
    lost = (t - sum) - y;
    sum = t;
  }
};
template <typename T>
struct Plain {
  T sum = 0;
  void add(T x) { sum += x; }
};

// I and D as in common/pid.hpp, neither limited nor filtered.
template <typename T, template <typename> typename Sum>
struct Positional {
  T kp = T(kGains.kp), half_ki_Ts = T(kGains.ki) * T(kTs) / 2, kd_per_Ts = T(kGains.kd) / T(kTs);
  Sum<T> I{};
  T e1 = 0;
  T operator()(double x) {
    const T e = T(x);
    I.add(half_ki_Ts * (e + e1));
    const T u = kp * e + I.sum + kd_per_Ts * (e - e1);
    e1 = e;
    return u;
  }
};

struct Ours {
  Pid pid = make_pid(kGains, kTs);
  PidState state{.primed = true};
  double operator()(double e) { return step(pid, state, e, 0); }
};
struct Incremental {
  IncrementalPid pid = make_incremental_pid(kGains, kTs);
  double operator()(double e) { return step(pid, e); }
};
struct IncrementalCompensated {
  IncrementalPid pid = make_incremental_pid(kGains, kTs);
  Compensated<double> u{};
  double operator()(double e) {
    u.add(pid.a * e + pid.b * pid.e1 + pid.c * pid.e2);
    pid.e2 = pid.e1;
    pid.e1 = e;
    return u.sum;
  }
};

template <typename T>
T pole() {
  return -std::expm1(-2 * std::numbers::pi_v<T> * T(kCutoff) * T(kTs));
}
template <typename T, template <typename> typename Sum>
struct Difference {  // as the product does
  T gain = std::is_same_v<T, double> ? T(low_pass_gain(kCutoff, kTs)) : pole<T>();
  Sum<T> y{};
  T operator()(double x) {
    y.add(gain * (T(x) - y.sum));
    return y.sum;
  }
};
template <typename T>
struct TwoProducts {
  T gain = pole<T>(), y = 0;
  T operator()(double x) { return y = (1 - gain) * y + gain * T(x); }
};

// Largest error just before each of the counts of ticks.
template <typename Form, typename Exact>
std::vector<double> errors(const std::vector<std::uint64_t>& counts) {
  Form form;
  Exact exact;
  Signal signal;
  std::vector<double> out;
  std::uint64_t tick = 0;
  for (const std::uint64_t count : counts) {
    double worst = 0;
    for (; tick < count; ++tick) {
      const double e = signal.next();
      const auto difference = static_cast<long double>(form(e)) - exact(e);
      if (tick + kWindow >= count) worst = std::max(worst, std::abs(double(difference)));
    }
    out.push_back(worst);
  }
  return out;
}

template <typename Form, typename Exact>
void contend(Table& table, const char* subject, const char* contender, const char* unit) {
  std::vector<std::uint64_t> counts{1000, 100000, 10000000};
  if (table.quick()) counts.pop_back();
  if (table.long_run()) counts.push_back(1000000000);
  const std::vector<double> error = errors<Form, Exact>(counts);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    char set[30];
    std::snprintf(set, sizeof set, "after %.0e ticks", double(counts[i]));
    rows.push_back({{subject, contender, set}, {error[i], error[i], unit, kWindow}});
  }
  Signal signal;
  std::vector<double> inputs(kTimed);
  for (double& x : inputs) x = signal.next();
  table.time(std::move(rows), inputs.size(),
             [inputs, form = Form{}](std::size_t i) mutable { return form(inputs[i]); });
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  using namespace farhand::bench;
  Table table(argc, argv);
  using ExactPid = Positional<long double, Compensated>;
  contend<Ours, ExactPid>(table, "PID", kOurs, "N");
  contend<Incremental, ExactPid>(table, "PID", "incremental", "N");
  contend<IncrementalCompensated, ExactPid>(table, "PID", "incremental, compensated", "N");
  contend<Positional<double, Plain>, ExactPid>(table, "PID", "positional, unlimited", "N");
  contend<Positional<double, Compensated>, ExactPid>(table, "PID", "positional, compensated", "N");
  contend<Positional<float, Plain>, ExactPid>(table, "PID", "positional, float", "N");
  using ExactFilter = Difference<long double, Compensated>;
  contend<Difference<double, Plain>, ExactFilter>(table, "low-pass", kOurs, "m");
  contend<Difference<double, Compensated>, ExactFilter>(table, "low-pass", "compensated", "m");
  contend<TwoProducts<double>, ExactFilter>(table, "low-pass", "two products", "m");
  contend<Difference<float, Plain>, ExactFilter>(table, "low-pass", "float", "m");
  return table.finish();
}
