// The secure channel of a program: its half beside the loop on a thread of its own, which also
// tells the user when the keys differ.
#pragma once

#include <string>
#include <thread>

#include "common/secure_channel.hpp"

namespace farhand {

class SecureService {
 public:
  SecureService(const SecureChannelConfig& config, const Key& key);

  SecureChannel& channel() noexcept { return channel_; }
  const std::string& key_name() const noexcept { return key_name_; }

 private:
  void run(const std::stop_token& stop);

  SecureChannel channel_;
  bool is_client_;
  std::string key_name_;
  std::jthread thread_;
};

}  // namespace farhand
