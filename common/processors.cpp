#include "common/processors.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace farhand {
namespace {

std::optional<int> parse_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0) return {};
  return number < CPU_SETSIZE ? std::optional(number) : std::nullopt;
}

// 0 to as many as the machine has.
std::string existing() {
  const long count = std::max(sysconf(_SC_NPROCESSORS_CONF), 1L);
  return count == 1 ? "0" : "0 to " + std::to_string(count - 1);
}

}  // namespace

Processors own_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  Processors out;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) out.push_back(cpu);
  return out;
}

std::optional<Processors> parse_processors(const std::string& text) {
  Processors out;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto dash = part.find('-');
    const auto first = parse_number(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : parse_number(part.substr(dash + 1));
    if (!first || !last || *last < *first) return {};
    for (int cpu = *first; cpu <= *last; ++cpu) out.push_back(cpu);
  }
  return out;
}

std::string to_string(const Processors& processors) {
  std::string out;
  for (std::size_t i = 0; i < processors.size();) {
    std::size_t last = i;
    while (last + 1 < processors.size() && processors[last + 1] == processors[last] + 1) ++last;
    out += (out.empty() ? "" : ",") + std::to_string(processors[i]);
    if (last > i) out += "-" + std::to_string(processors[last]);
    i = last + 1;
  }
  return out;
}

int run_on(const Processors& processors) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int cpu : processors)
    if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(cpu, &set);
  return sched_setaffinity(0, sizeof set, &set) == 0 ? 0 : errno;
}

std::string processor_refusal(int cpu, int error) {
  const std::string name = "processor " + std::to_string(cpu);
  if (error != EINVAL)
    return name + " is refused (" + std::strerror(error) + "): allow sched_setaffinity";
  if (cpu < 0 || cpu >= std::min<long>(sysconf(_SC_NPROCESSORS_CONF), CPU_SETSIZE))
    return "there is no " + name + ": name one from " + existing() +
           " as realtime { cpu }, or leave it out";
  return name +
         " is off or not allowed here: switch it on, or allow it (AllowedCPUs= of the service, "
         "cpuset of the container), or name another one as realtime { cpu }";
}

// Isolated processors are in nobody's set and may be asked for all the same, so only trying tells.
void reserve_processor(int cpu) {
  Processors others = own_processors();
  if (const int error = run_on({cpu}); error != 0)
    throw std::runtime_error(processor_refusal(cpu, error));
  if (others.size() > 1) std::erase(others, cpu);
  run_on(others);
}

}  // namespace farhand
