// A command that runs in the mocked machine of this process: it sees the devices of its mock bus
// and no others of their kind.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace farhand::falcon_usb {

// Loads the mock's library before all others, which takes running this program from its begin once
// more. Returns when that is so, and throws a sentence if it cannot be.
void mock_this_process(char** argv);

class MockedChild {
 public:
  // Throws a sentence if the command cannot be run.
  explicit MockedChild(const std::vector<std::string>& command);

  // Its exit status, 128 and the signal's number if one ended it, or none while it runs.
  std::optional<int> status();
  void terminate() const noexcept;  // asks it to end

 private:
  pid_t id_ = 0;
};

}  // namespace farhand::falcon_usb
