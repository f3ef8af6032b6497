#include "common/secure_service.hpp"

#include <spdlog/spdlog.h>

#include "common/realtime.hpp"

namespace farhand {

SecureService::SecureService(const SecureChannelConfig& config, const Key& key)
    : channel_(config, key),
      is_client_(config.server.has_value()),
      key_name_(key.name),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

// Once only: anyone can provoke it.
void SecureService::run(const std::stop_token& stop) {
  constexpr Duration kPause = std::chrono::milliseconds(5);
  bool told = false;
  while (!stop.stop_requested()) {
    channel_.service(monotonic_now());
    if (!told && channel_.counters().other_key > 0) {
      told = true;
      spdlog::warn(
          "{} has another key than this side ({}): copy one key file, made by farhand-keygen, to "
          "both machines",
          is_client_ ? "the slave" : "a master that would connect", key_name_);
    }
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace farhand
