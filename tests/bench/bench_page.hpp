// bench.html: what is met and missed, where a rival is better, then every figure and picture.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/result.hpp"

namespace farhand::bench {

std::string bench_page(const std::vector<Result>& all, const std::vector<std::string>& facts);

// For tables and for the console: "123 ns", "4.56 us"; "" for kNone.
std::string time_text(double ns);
std::string time_text_or_never(double ns);
std::string error_text(double error);

}  // namespace farhand::bench
