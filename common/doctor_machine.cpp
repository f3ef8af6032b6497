#include "common/doctor_machine.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>

namespace farhand::doctor {
namespace {

constexpr const char* kNotVisible = "not visible from here";

std::optional<std::int64_t> number_in(const std::filesystem::path& file) {
  const auto line = first_line(file);
  std::int64_t value = 0;
  if (!line || std::from_chars(line->data(), line->data() + line->size(), value).ec != std::errc())
    return {};
  return value;
}

std::optional<std::uint64_t> available_kib(const std::filesystem::path& meminfo) {
  std::ifstream in(meminfo);
  std::uint64_t kib = 0;
  for (std::string name, unit; in >> name >> kib; std::getline(in, unit))
    if (name == "MemAvailable:") return kib;
  return {};
}

// What says so, or nothing.
std::optional<std::string> hypervisor(const std::filesystem::path& root) {
  if (const auto type = first_line(root / "sys/hypervisor/type")) return *type;
  for (const char* name : {"sys/class/dmi/id/sys_vendor", "sys/class/dmi/id/product_name"})
    for (const char* maker : {"QEMU", "KVM", "VMware", "VirtualBox", "Virtual Machine", "Xen"})
      if (first_line(root / name).value_or("").find(maker) != std::string::npos) return maker;
  std::ifstream in(root / "proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("flags") && (line + " ").find(" hypervisor ") != std::string::npos)
      return "the processor's flags";
  return {};
}

}  // namespace

std::optional<std::string> first_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  if (!in.is_open() || in.bad()) return {};
  return line;
}

Finding clock_source(const std::filesystem::path& root) {
  const auto name =
      first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (!name) return {Level::ok, "clock", kNotVisible};
  constexpr std::array kSlow = {"hpet", "acpi_pm", "pit", "jiffies", "refined-jiffies"};
  if (std::find(kSlow.begin(), kSlow.end(), *name) == kSlow.end())
    return {Level::ok, "clock", *name};
  return {Level::warning, "clock",
          *name +
              " is slow or coarse to read: boot with clocksource=tsc tsc=reliable, if the kernel's "
              "log does not say that the tsc is unstable"};
}

Finding throttling(const std::filesystem::path& root, double share) {
  const auto runtime = number_in(root / "proc/sys/kernel/sched_rt_runtime_us");
  const auto period = number_in(root / "proc/sys/kernel/sched_rt_period_us").value_or(1'000'000);
  if (!runtime) return {Level::ok, "throttling", kNotVisible};
  if (*runtime < 0)
    return {Level::ok, "throttling", "off: a real-time thread that hangs keeps its processor"};
  const double allowed =
      static_cast<double>(*runtime) / static_cast<double>(std::max(period, std::int64_t{1}));
  const std::string text =
      fmt::format("real-time threads may take {:g} % of a processor, the loop wants up to {:g} %",
                  100 * allowed, 100 * share);
  if (allowed >= share) return {Level::ok, "throttling", text};
  return {Level::warning, "throttling",
          text + fmt::format(": sysctl kernel.sched_rt_runtime_us={}", period * 95 / 100) +
              ", or lower realtime { spin_us }"};
}

Finding governor(const std::filesystem::path& root, const Processors& used) {
  Processors seen, slow;
  std::string other;
  for (const int cpu : used) {
    const auto name = first_line(
        root / fmt::format("sys/devices/system/cpu/cpu{}/cpufreq/scaling_governor", cpu));
    if (!name) continue;
    seen.push_back(cpu);
    if (*name == "performance") continue;
    slow.push_back(cpu);
    other = *name;
  }
  if (seen.empty()) return {Level::ok, "frequency", kNotVisible};
  if (slow.empty())
    return {Level::ok, "frequency", "governor performance on processor " + to_string(seen)};
  return {Level::warning, "frequency",
          fmt::format("governor {} on processor {} saves power between ticks: cpupower "
                      "frequency-set -g performance",
                      other, to_string(slow))};
}

Finding processors(const std::filesystem::path& root, const Processors& allowed,
                   std::optional<int> cpu, int error) {
  if (cpu && error != 0) return {Level::problem, "processors", processor_refusal(*cpu, error)};
  if (!cpu && allowed.size() == 1)
    return {Level::warning, "processors",
            "the loop shares the only one with everything else: allow the program a second one"};
  if (!cpu)
    return {Level::ok, "processors",
            to_string(allowed) + ", and the loop on any of them (realtime { cpu } pins it)"};
  const auto isolated =
      parse_processors(first_line(root / "sys/devices/system/cpu/isolated").value_or(""));
  if (isolated && std::find(isolated->begin(), isolated->end(), *cpu) != isolated->end())
    return {Level::ok, "processors", fmt::format("{} is isolated and the loop's own", *cpu)};
  return {Level::warning, "processors",
          fmt::format("the loop is pinned to {0}, where other programs run too: boot with "
                      "isolcpus={0} nohz_full={0} rcu_nocbs={0}",
                      *cpu)};
}

Finding memory(const std::filesystem::path& root) {
  const auto kib = available_kib(root / "proc/meminfo");
  if (!kib) return {Level::ok, "memory", kNotVisible};
  const std::string text = fmt::format("{} MiB available", *kib / 1024);
  if (*kib / 1024 >= kMemoryMiB) return {Level::ok, "memory", text};
  return {Level::warning, "memory",
          text + fmt::format(", and a side wants {}: end other programs", kMemoryMiB)};
}

std::optional<StolenTime> stolen_time(const std::filesystem::path& root) {
  std::istringstream line(first_line(root / "proc/stat").value_or(""));
  std::string name;
  StolenTime out;
  if (!(line >> name) || name != "cpu") return {};
  constexpr int kStolen = 7;  // user, nice, system, idle, iowait, irq, softirq, steal
  for (int i = 0; i <= kStolen; ++i) {
    if (!(line >> out.stolen)) return {};
    out.all += out.stolen;
  }
  return out;
}

Finding virtual_machine(const std::filesystem::path& root, const std::optional<StolenTime>& before,
                        const std::optional<StolenTime>& after) {
  const auto maker = hypervisor(root);
  if (!maker) return {Level::ok, "machine", "no sign that it is virtual"};
  std::string stolen = "how much is not visible";
  if (before && after && after->all > before->all)
    stolen = fmt::format("{:.1f} % of the last second",
                         100 * static_cast<double>(after->stolen - before->stolen) /
                             static_cast<double>(after->all - before->all));
  return {Level::warning, "machine",
          fmt::format("virtual ({}), so its host may withhold the processors ({}): run real "
                      "hardware from a machine of its own",
                      *maker, stolen)};
}

}  // namespace farhand::doctor
