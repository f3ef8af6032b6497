// --doctor: whether this machine, this build and this scene are fit for a side, a line for each
// thing looked at, with the remedy where it is not. Moves nothing and sends no datagram.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace farhand {
struct ProgramOptions;
struct Scene;
}  // namespace farhand

namespace farhand::doctor {

// ok: fit, or not to be seen from here. warning: the program runs, with jitter or at a risk that
// the text names. problem: it would not start, or have no device to work with.
enum class Level : std::uint8_t { ok, warning, problem };

struct Finding {
  Level level = Level::ok;
  std::string subject;
  std::string text;  // "what is: remedy"
};
using Findings = std::vector<Finding>;
using Look = std::function<Findings(const Scene&)>;  // at what only one side's program knows

// A line each, then one that counts.
std::string to_text(const Findings& findings);

// Looks at everything for "master" or "slave", and at what `more` does if it is there and the scene
// is good; takes about a second, prints to stdout. Exit status: 1 if anything is a problem, else 0.
// The calling thread keeps the loop's priority and processor.
int run(const std::string& side, const ProgramOptions& options, const Look& more = {});

}  // namespace farhand::doctor
