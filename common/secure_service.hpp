// The secure channel of a program: its half beside the loop on a thread of its own, which also
// tells the user why the two sides cannot connect.
#pragma once

#include <string>
#include <thread>

#include "common/secure_channel.hpp"

namespace farhand {

// Of the other side, if `seen` here, or of this one, as the other side says. `own` as to_string
// writes it.
std::string sentence(Mismatch mismatch, bool seen, DtlsRole role, const std::string& own);

class SecureService {
 public:
  SecureService(const SecureChannelConfig& config, const Credentials& credentials);

  SecureChannel& channel() noexcept { return channel_; }
  // As to_string(Credentials).
  const std::string& credentials() const noexcept { return credentials_; }

 private:
  void run(const std::stop_token& stop);
  void tell();

  SecureChannel channel_;
  DtlsRole role_;
  std::string credentials_;
  DtlsCounters told_;
  std::jthread thread_;
};

}  // namespace farhand
