// Which processors a thread may run on, and one of them kept for the loop.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace farhand {

using Processors = std::vector<int>;  // numbers from 0, ascending

// The calling thread's; empty if the system does not say.
Processors own_processors();

// As the kernel writes them: "0-3,6" is {0, 1, 2, 3, 6}. Nothing for any other text; an empty one
// is none.
std::optional<Processors> parse_processors(const std::string& text);
std::string to_string(const Processors& processors);

// The calling thread, and those it will start, run on these only. 0, or an errno: EINVAL if none of
// them is there and allowed.
int run_on(const Processors& processors) noexcept;

// One sentence, with the remedy, for an error of run_on({cpu}).
std::string processor_refusal(int cpu, int error);

// Keeps the calling thread, and those it will start, off this processor, so that it is there for
// the loop; where it is the only one they stay. Throws a sentence if no thread may run on it.
void reserve_processor(int cpu);

}  // namespace farhand
