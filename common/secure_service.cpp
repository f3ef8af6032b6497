#include "common/secure_service.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "common/realtime.hpp"

namespace farhand {
namespace {

constexpr const char* kNewOnes = "make new certificates with farhand-keygen --certificates";

std::string about_secrets(const std::string& who_has, const std::string& own) {
  if (own.starts_with("key"))
    return fmt::format(
        "{} another key than this side ({}): copy one key file, made by farhand-keygen, to both "
        "machines",
        who_has, own.substr(own.find(' ') + 1));
  return fmt::format(
      "{} a certificate of another authority than this side ({}): give both sides what one run of "
      "farhand-keygen --certificates made",
      who_has, own);
}

}  // namespace

std::string sentence(Mismatch mismatch, bool seen, DtlsRole role, const std::string& own) {
  const bool is_client = role == DtlsRole::client;
  const std::string other = is_client ? "the slave" : "a master that would connect";
  const std::string whose =
      seen ? "the certificate of " + other : other + " says that the certificate of this side";
  const std::string who = seen ? other : other + " says that it";
  switch (mismatch) {
    case Mismatch::other_secret:
      return about_secrets(who + " has", own);
    case Mismatch::other_kind:
      return fmt::format(
          "{} proves itself otherwise than this side ({}): name a key_file in the "
          "link of both scenes, or certificates in both",
          who, own);
    case Mismatch::expired:
      return fmt::format("{} has expired: {}, or set the clocks of both machines", whose, kNewOnes);
    case Mismatch::not_yet_valid:
      return fmt::format("{} is not valid yet: set the clocks of both machines", whose);
    case Mismatch::wrong_role:
      return fmt::format(
          "{} is not {}: name the one made for that side; if somebody else uses it "
          "there, it is stolen: {}",
          whose, is_client == seen ? "a slave's" : "a master's", kNewOnes);
  }
  return {};
}

SecureService::SecureService(const SecureChannelConfig& config, const Credentials& credentials)
    : channel_(config, credentials),
      role_(config.server ? DtlsRole::client : DtlsRole::server),
      credentials_(to_string(credentials)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void SecureService::run(const std::stop_token& stop) {
  constexpr Duration kPause = std::chrono::milliseconds(5);
  while (!stop.stop_requested()) {
    const TimePoint now = monotonic_now();
    channel_.service(now);
    tell(now);
    std::this_thread::sleep_for(kPause);
  }
}

// Seldom: anyone can provoke it.
bool Seldom::due(std::uint64_t count, TimePoint now) noexcept {
  constexpr Duration kPause = std::chrono::minutes(1);
  if (count == told_ || (told_at_ && now - *told_at_ < kPause)) return false;
  told_ = count;
  told_at_ = now;
  return true;
}

void SecureService::tell(TimePoint now) {
  const DtlsCounters& c = channel_.counters();
  for (std::size_t i = 0; i < kMismatches; ++i) {
    const auto m = static_cast<Mismatch>(i);
    if (seen_[i].due(c.seen[i], now)) spdlog::warn("{}", sentence(m, true, role_, credentials_));
    if (said_[i].due(c.said[i], now)) spdlog::warn("{}", sentence(m, false, role_, credentials_));
  }
  const std::string& peer = channel_.peer_certificate();
  if (!peer.empty() && (connected_.due(c.done, now) || peer != peer_))
    spdlog::info("connected with {} of certificate {}",
                 role_ == DtlsRole::client ? "the slave" : "a master", peer);
  peer_ = peer;
}

}  // namespace farhand
