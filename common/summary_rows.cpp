#include "common/summary_rows.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/mode.hpp"

namespace farhand {

std::string mode_row(std::uint64_t ticks, const std::array<std::uint64_t, kModes>& ticks_in_mode) {
  std::string out = fmt::format("  ticks {}", ticks);
  for (std::size_t m = 0; m < ticks_in_mode.size(); ++m)
    if (ticks_in_mode[m] > 0)
      out += fmt::format(", {} {}", to_string(static_cast<Mode>(m)), ticks_in_mode[m]);
  return out + "\n";
}

std::string limit_row(const LimitCounts& limits) {
  std::string out;
  for (int bit = 0; bit < kLimitCount; ++bit)
    if (limits.ticks[bit] > 0) out += fmt::format(", {} {}", limit_name(bit), limits.ticks[bit]);
  return out.empty() ? "  limits acted in no tick\n"
                     : "  limits acted (ticks): " + out.substr(2) + "\n";
}

std::string lost_records_row(std::uint64_t lost) {
  return lost == 0
             ? std::string{}
             : fmt::format("  records lost {}: the disk or the terminal was too slow\n", lost);
}

}  // namespace farhand
