#include <spdlog/fmt/fmt.h>

#include <cstdio>

#include "common/histogram.hpp"
#include "common/realtime.hpp"
#include "master/falcon_usb/advice.hpp"
#include "master/falcon_usb/tool/commands.hpp"
#include "master/falcon_usb/usb_list.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr Duration kSetUp = std::chrono::seconds(5), kUpload = std::chrono::minutes(2);

std::string openable(const Found& f) {
  if (f.kernel_driver) return "can be opened, and is then taken from a driver of the kernel's";
  if (f.refusal == Refusal::none) return "can be opened";
  return advice({.phase = Phase::failed, .trouble = trouble_of(f.refusal)});
}

std::string buttons(std::uint8_t pressed) {
  std::string out;
  for (const auto& [bit, name] :
       {std::pair{kButtonCentre, "centre"}, std::pair{kButtonForward, "forward"},
        std::pair{kButtonPlus, "plus"}, std::pair{kButtonMinus, "minus"}})
    if ((pressed & bit) != 0) out += (out.empty() ? "" : " ") + std::string(name);
  return out.empty() ? "none" : out;
}

std::string homed(std::uint8_t axes) {
  std::string out;
  for (int i = 0; i < 3; ++i)
    out += fmt::format("{}axis {} {}", i == 0 ? "" : ", ", i + 1, (axes >> i & 1) ? "yes" : "no");
  return out;
}

bool answers(Session& session) {
  const Phase phase = session.driver().status().phase;
  return phase == Phase::homing || phase == Phase::homed || phase == Phase::armed;
}

void wait_for_answers(Session& session, Duration most) {
  if (!session.run(most, [&](TimePoint) { return answers(session); }))
    throw std::runtime_error("the Falcon does not answer; is one plugged in?");
}

double milli(Duration d) {
  return 1e3 * seconds(d);
}

}  // namespace

int list() {
  const auto found = list_falcons();
  for (const Found& f : found)
    std::printf("bus %d device %d  serial %s  %s\n", f.bus, f.address,
                f.serial.empty() ? "unknown" : f.serial.c_str(), openable(f).c_str());
  if (found.empty())
    std::puts("no Falcon on the USB; plug it in, directly rather than through a hub");
  return found.empty() ? 1 : 0;
}

int info(Session& session) {
  constexpr Duration kLook = std::chrono::seconds(2);
  wait_for_answers(session, kSetUp);
  Histogram gaps;
  const ExchangeCounters before = session.driver().status().exchange;
  std::optional<TimePoint> last;
  session.run(kLook, [&](TimePoint) {
    const auto& answer = session.driver().newest();
    if (answer && last && answer->at != *last) gaps.add(answer->at - *last);
    if (answer) last = answer->at;
    return false;
  });
  const DriverStatus status = session.driver().status();
  const auto accepted = status.exchange.accepted - before.accepted;
  std::printf("firmware    answers\nhomed       %s\n", homed(status.homed).c_str());
  if (const auto& s = session.driver().newest())
    std::printf("encoders    %d %d %d counts\nbuttons     %s\n", s->answer.encoders[0],
                s->answer.encoders[1], s->answer.encoders[2], buttons(s->answer.buttons).c_str());
  std::printf("exchanges   %.0f per second, %.2f ms apart p50, %.2f ms p99, %llu asked again\n",
              static_cast<double>(accepted) / seconds(kLook), milli(gaps.quantile(0.5)),
              milli(gaps.quantile(0.99)),
              static_cast<unsigned long long>(status.exchange.unanswered - before.unanswered));
  return 0;
}

int upload(Session& session) {
  int shown = -1;
  const bool done = session.run(kUpload, [&](TimePoint) {
    const DriverStatus status = session.driver().status();
    const int percent = static_cast<int>(100 * status.upload_progress);
    if (status.phase == Phase::uploading && percent != shown) {
      shown = percent;
      std::fprintf(stderr, "\r[%-50s] %3d %%  attempt %d ",
                   std::string(static_cast<std::size_t>(percent / 2), '#').c_str(), percent,
                   status.upload_attempt);
    }
    return answers(session);
  });
  if (!done) throw std::runtime_error("the Falcon does not answer; is one plugged in?");
  if (shown >= 0) std::fputc('\n', stderr);
  std::puts(shown >= 0
                ? "the firmware runs"
                : "firmware runs already; to load another, switch the Falcon's supply off and on");
  return 0;
}

int monitor(Session& session, const FalconGeometry& geometry, Duration most) {
  constexpr Duration kShow = std::chrono::milliseconds(100);
  TimePoint show{};
  try {
    session.run(most, [&](TimePoint now) {
      const auto& s = session.driver().newest();
      if (!s || now < show) return false;
      show = now + kShow;
      const auto& n = s->answer.encoders;
      const FalconForward at =
          forward(geometry, theta1_from_counts(geometry, Eigen::Vector3i(n[0], n[1], n[2])));
      const DriverStatus status = session.driver().status();
      const Vec3 mm = 1e3 * at.p_MH;
      std::fprintf(stderr,
                   "\r%-6s  counts %6d %6d %6d  grip (%6.1f %6.1f %6.1f) mm  buttons %-14s  "
                   "asked again %llu  left out %llu ",
                   to_string(status.phase), n[0], n[1], n[2], mm.x(), mm.y(), mm.z(),
                   buttons(s->answer.buttons).c_str(),
                   static_cast<unsigned long long>(status.exchange.unanswered),
                   static_cast<unsigned long long>(status.implausible));
      return false;
    });
  } catch (const std::exception&) {
    if (!stop_requested()) throw;  // Ctrl-C is how one leaves
  }
  std::fputc('\n', stderr);
  return 0;
}

}  // namespace farhand::falcon_usb
