// What the programs have in common outside their loops: arguments, --plan and --check, errors as
// one sentence, warnings.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/doctor.hpp"
#include "common/scene.hpp"
#include "common/secure_service.hpp"
#include "common/time.hpp"
#include "common/udp.hpp"

namespace farhand {

// SCHED_FIFO, below the kernel's own threads. Where both loops share a processor the slave's gives
// way: the answer becomes force before the slave has tidied up behind it.
inline constexpr int kLoopPriority = 80;
inline constexpr int kSlaveLoopPriority = kLoopPriority - 1;

struct ProgramOptions {
  std::string scene;
  bool plan = false;
  bool check = false;
  bool doctor = false;
  bool quiet = false;                 // no live status line
  double duration_s = 0;              // 0: until stopped
  std::optional<std::string> listen;  // host:port instead of the scene's
  std::optional<std::string> record;  // MCAP file to write
  std::optional<std::string> slave;   // master only
  bool take_over = false;             // master only
  std::optional<std::string> trace;   // motion of the simulated hand; master only

  Duration limit() const noexcept {
    return duration_s > 0 ? from_seconds(duration_s) : std::chrono::hours(24 * 365);
  }
};

// Parses the arguments, runs `body`, or the doctor if it was asked for, which looks at what `more`
// does, too, and turns what it throws into one line on stderr. Exit status: what body returns, 1
// after an error, 2 for arguments that make no sense.
int run_program(int argc, char** argv, const std::string& name, const std::string& description,
                const std::function<int(const ProgramOptions&)>& body,
                const doctor::Look& more = {});

// The error half of run_program, for programs with other arguments.
int run_guarded(const std::string& name, const std::function<int()>& body);

using Stages = std::vector<std::pair<std::string, std::vector<std::string>>>;  // by side

// True if --check or --plan was asked for: prints the answer, and nothing more is to be done.
bool print_only(const ProgramOptions& options, const Scene& scene, const Stages& stages);

// Throws with a sentence if the scene has no slave.
void require_slave(const Scene& scene);

// Throws with a sentence if a flag is about the slave although the scene has nobody to talk to.
void refuse_addresses(const ProgramOptions& options, const Scene& scene);

// The address a flag gave, or else the scene's. Throws with a sentence if it reaches beyond this
// machine and the scene neither names a key or certificates nor says insecure.
UdpAddress link_address(const std::optional<std::string>& flag, const std::string& scenes,
                        const Scene& scene);

// The secure channel of a scene that names a key or certificates, of the client of `server` or of a
// server; nullptr for any other, with a warning if it says insecure. Throws as link_credentials.
std::unique_ptr<SecureService> make_secure(const Scene& scene,
                                           const std::optional<UdpAddress>& server = {});

// ", key 01234567" or as to_string(Credentials) says, or nothing.
std::string with_credentials(const SecureService* secure);

// The calling thread becomes the loop's, as the scene's words about this side's machine say. What
// was refused is warned of; for a real device it throws a sentence unless the scene allows it.
void start_realtime(const proto::Realtime& realtime, bool real_device, int priority);

// Start-up line and warnings, on stderr.
void announce(const Scene& scene, const std::string& where);
void warn_each(const std::vector<std::string>& sentences);

// From the system's random source; never 0.
std::uint64_t random_session();

}  // namespace farhand
