// What the files of the kernel tell the doctor of the machine. `root` is "/"; what is not visible
// below it, as in a container, is no fault.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "common/doctor.hpp"
#include "common/processors.hpp"

namespace farhand::doctor {

// Without the line's end; nothing if the file cannot be read.
std::optional<std::string> first_line(const std::filesystem::path& file);

// Reading the time must not be a journey to a chip.
Finding clock_source(const std::filesystem::path& root);

// The share of a processor that real-time threads may take; the loop wants `share` of it.
Finding throttling(const std::filesystem::path& root, double share);

// Of these processors.
Finding governor(const std::filesystem::path& root, const Processors& used);

// `cpu`: what the loop is to be pinned to, if anything; `error`: of pinning it there.
Finding processors(const std::filesystem::path& root, const Processors& allowed,
                   std::optional<int> cpu, int error);

// Twice what a side of twin_delta_contact holds; locked, none of it can be swapped out.
inline constexpr std::uint64_t kMemoryMiB = 64;
Finding memory(const std::filesystem::path& root);

// Time that the machine's processors were there for, and what of it went to other machines on the
// same host, in any unit; nothing if it is not visible.
struct StolenTime {
  std::uint64_t all = 0;
  std::uint64_t stolen = 0;
};
std::optional<StolenTime> stolen_time(const std::filesystem::path& root);

// Of a time between two readings.
Finding virtual_machine(const std::filesystem::path& root, const std::optional<StolenTime>& before,
                        const std::optional<StolenTime>& after);

}  // namespace farhand::doctor
