// Whether encoder counts can be what they say they are: within the device's reach, and no farther
// from the last ones than a hand can move it meanwhile. What a wrong letter inside a packet does is
// seen here and nowhere else.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

#include "master/falcon.hpp"
#include "master/falcon_usb/exchange.hpp"

namespace farhand::falcon_usb {

struct PlausibilityConfig {
  double max_rate = 40;    // of an arm [rad/s]: the grip at 2 m/s and more
  int most_counts = 2000;  // either way of zero; 1600 are in use
  int in_a_row = 4;        // so many implausible ones mean that the encoders' zero has jumped
};

enum class Verdict : std::uint8_t {
  plausible,
  first,  // nothing to judge it by: the next one must agree
  implausible,
};

class Plausibility {
 public:
  Plausibility(const PlausibilityConfig& config, const FalconGeometry& geometry) noexcept
      : config_(config), counts_per_s_(config.max_rate / theta1_quantum(geometry)) {}

  void forget() noexcept { last_.reset(), confirmed_ = false, bad_ = 0; }
  // Judges against the last plausible one. As long as no two agree, each is judged by the one
  // before.
  Verdict judge(const Sample& sample) noexcept {
    const bool first = !last_, in_reach = reachable(sample), good = in_reach && near_last(sample);
    if (good || (!confirmed_ && in_reach)) last_ = sample;
    if (good && first) return Verdict::first;
    confirmed_ = confirmed_ || good;
    bad_ = good ? 0 : bad_ + 1;
    return good ? Verdict::plausible : Verdict::implausible;
  }
  bool jumped() const noexcept { return bad_ >= config_.in_a_row; }

 private:
  bool reachable(const Sample& sample) const noexcept {
    for (const int counts : sample.answer.encoders)
      if (std::abs(counts) > config_.most_counts) return false;
    return true;
  }
  bool near_last(const Sample& sample) const noexcept {
    if (!last_) return true;
    const double most = 1 + counts_per_s_ * seconds(sample.at - last_->at + kExchange);
    for (std::size_t i = 0; i < 3; ++i)
      if (std::abs(sample.answer.encoders[i] - last_->answer.encoders[i]) > most) return false;
    return true;
  }

  static constexpr Duration kExchange = std::chrono::milliseconds(1);  // either may be so late

  PlausibilityConfig config_;
  double counts_per_s_;
  std::optional<Sample> last_;
  bool confirmed_ = false;  // last_ agreed with one before it
  int bad_ = 0;             // in a row
};

}  // namespace farhand::falcon_usb
