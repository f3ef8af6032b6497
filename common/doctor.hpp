// --doctor: whether this machine, this build and this scene are fit for a side, a line for each
// thing looked at, with the remedy where it is not. Opens no device and sends no datagram.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace farhand {
struct ProgramOptions;
}

namespace farhand::doctor {

// ok: fit, or not to be seen from here. warning: the program runs, with jitter or at a risk that
// the text names. problem: it would not start.
enum class Level : std::uint8_t { ok, warning, problem };

struct Finding {
  Level level = Level::ok;
  std::string subject;
  std::string text;  // "what is: remedy"
};
using Findings = std::vector<Finding>;

// A line each, then one that counts.
std::string to_text(const Findings& findings);

// Looks at everything for "master" or "slave", takes about a second, prints to stdout. Exit status:
// 1 if anything is a problem, else 0. The calling thread keeps the loop's priority and processor.
int run(const std::string& side, const ProgramOptions& options);

}  // namespace farhand::doctor
