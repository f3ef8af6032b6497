#include "common/secure_service.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "common/realtime.hpp"

namespace farhand {
namespace {

constexpr const char* kNewOnes = "make new certificates with farhand-keygen --certificates";

std::string about_secrets(const std::string& other, const std::string& own) {
  if (own.starts_with("key"))
    return fmt::format(
        "{} has another key than this side ({}): copy one key file, made by farhand-keygen, to "
        "both machines",
        other, own.substr(own.find(' ') + 1));
  return fmt::format(
      "{} has a certificate of another authority than this side ({}): give both sides what one "
      "run of farhand-keygen --certificates made",
      other, own);
}

}  // namespace

std::string sentence(Mismatch mismatch, bool seen, DtlsRole role, const std::string& own) {
  const bool is_client = role == DtlsRole::client;
  const std::string other = is_client ? "the slave" : "a master that would connect";
  const std::string whose =
      seen ? "the certificate of " + other : other + " says that the certificate of this side";
  switch (mismatch) {
    case Mismatch::other_secret:
      return about_secrets(other, own);
    case Mismatch::other_kind:
      return fmt::format(
          "{} proves itself otherwise than this side ({}): name a key_file in the "
          "link of both scenes, or certificates in both",
          other, own);
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
    channel_.service(monotonic_now());
    tell();
    std::this_thread::sleep_for(kPause);
  }
}

// Each once only: anyone can provoke it.
void SecureService::tell() {
  const auto first = [](std::uint64_t now, std::uint64_t& before) {
    return now > 0 && std::exchange(before, now) == 0;
  };
  for (std::size_t i = 0; i < kMismatches; ++i) {
    const auto m = static_cast<Mismatch>(i);
    const DtlsCounters& c = channel_.counters();
    if (first(c.seen[i], told_.seen[i])) spdlog::warn("{}", sentence(m, true, role_, credentials_));
    if (first(c.said[i], told_.said[i]))
      spdlog::warn("{}", sentence(m, false, role_, credentials_));
  }
}

}  // namespace farhand
