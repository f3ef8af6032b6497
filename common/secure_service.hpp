// The secure channel of a program: its half beside the loop on a thread of its own, which also
// tells the user why the two sides cannot connect.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "common/secure_channel.hpp"

namespace farhand {

// Of the other side, if `seen` here, or of this one, as the other side says. `own` as to_string
// writes it.
std::string sentence(Mismatch mismatch, bool seen, DtlsRole role, const std::string& own);

// Of what is counted, when to tell it: at the first, then at most once a minute.
class Seldom {
 public:
  bool due(std::uint64_t count, TimePoint now) noexcept;

 private:
  std::uint64_t told_ = 0;
  std::optional<TimePoint> told_at_;
};

class SecureService {
 public:
  SecureService(const SecureChannelConfig& config, const Credentials& credentials);

  SecureChannel& channel() noexcept { return channel_; }
  // As to_string(Credentials).
  const std::string& credentials() const noexcept { return credentials_; }

 private:
  void run(const std::stop_token& stop);
  void tell(TimePoint now);

  SecureChannel channel_;
  DtlsRole role_;
  std::string credentials_;
  std::array<Seldom, kMismatches> seen_, said_;
  Seldom connected_;
  std::string peer_;  // its certificate
  std::jthread thread_;
};

}  // namespace farhand
