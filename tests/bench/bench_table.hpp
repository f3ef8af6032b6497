// What every bench program is made of: rows of run time against error. A program computes the error
// of each contender on a set of inputs, hands the table the same inputs to time it on, and the
// table has Google Benchmark measure all rows interleaved and writes them as JSON.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "tests/bench/result.hpp"

namespace farhand::bench {

struct Label {
  std::string subject, contender, set, parameter{};
};

// Of the contender's answers on all inputs of the set, those it failed on included.
struct Accuracy {
  double usual = kNone;  // 99 of 100 inputs are no worse; kNone: the row has no error
  double worst = kNone;
  std::string unit{};
  std::size_t inputs = 0;
  std::string note{};
};
// Sorts the errors; NaN counts as infinite.
Accuracy accuracy(std::vector<double> errors, std::string unit, std::string note = {});

// One measurement may say the run time of several rows (the same run judged by two errors).
struct Row {
  Label label;
  Accuracy error{};
  double target_ns = kNone;  // what the project wants to reach
};

class Table {
 public:
  // Flags: --out FILE, --quick (few inputs and repetitions, for development), --long; what else is
  // given goes to Google Benchmark.
  Table(int argc, char** argv);

  bool quick() const noexcept { return quick_; }
  bool long_run() const noexcept { return long_; }
  // How many inputs of `full` this run looks at.
  std::size_t inputs(std::size_t full) const noexcept {
    return quick_ ? std::max<std::size_t>(64, full / 100) : full;
  }

  // f(i) does the work on input i, 0 <= i < inputs, and returns something that depends on it. It is
  // timed in batches over the inputs in turn, from 0 on. The time is divided by `per_call`.
  template <typename F>
  void time(std::vector<Row> rows, std::size_t inputs, F f, double per_call = 1,
            const char* time_of = "call");

  // Measures and writes. The exit status.
  int finish();

 private:
  struct Timed {
    std::vector<Row> rows;
    double per_call;
    std::string time_of;
  };
  std::string add(std::vector<Row> rows, double per_call, const char* time_of);
  void prepare(benchmark::internal::Benchmark* b) const;

  std::string out_ = "/dev/stdout";
  bool quick_ = false, long_ = false;
  std::vector<std::string> arguments_;
  std::vector<Timed> timed_;
  double load_before_ = 0;
};

template <typename F>
void Table::time(std::vector<Row> rows, std::size_t inputs, F f, double per_call,
                 const char* time_of) {
  const std::string name = add(std::move(rows), per_call, time_of);
  constexpr std::size_t kBatch = 64;
  const std::size_t batch = std::min(kBatch, inputs);
  prepare(benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) mutable {
    std::size_t i = 0;
    while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(batch))) {
      for (std::size_t n = 0; n < batch; ++n) {
        benchmark::DoNotOptimize(f(i));
        if (++i == inputs) i = 0;
      }
    }
  }));
}

}  // namespace farhand::bench
