#include "master/falcon_usb/tool/session.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "common/program.hpp"
#include "common/realtime.hpp"
#include "master/falcon_usb/advice.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr Duration kTurn = std::chrono::milliseconds(5);

DriverConfig with_firmware(DriverConfig c, const std::vector<std::byte>& firmware) {
  c.firmware = firmware;
  c.pacing = Pacing::device;
  return c;
}

// What is there of a line from the terminal, added to `line`; true once it is whole. Unbuffered, so
// that what waits can be seen.
bool read_line(std::string& line) {
  pollfd terminal{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  while (poll(&terminal, 1, 0) > 0) {
    char c = 0;
    if (read(STDIN_FILENO, &c, 1) != 1)
      throw std::runtime_error("the terminal is closed, and nobody answers");
    if (c == '\n') return true;
    line += c;
  }
  return false;
}

}  // namespace

Session::Session(SessionConfig config)
    : firmware_(std::move(config.firmware)),
      transport_(std::move(config.serial)),
      driver_(with_firmware(config.driver, firmware_)) {
  catch_stop_signals();
  // Where this is not permitted other programs may delay questions, which is seen in their rate.
  schedule_fifo(kLoopPriority);
}

Session::~Session() {
  constexpr Duration kPatience = std::chrono::milliseconds(200);
  driver_.close(monotonic_now());
  for (const TimePoint end = monotonic_now() + kPatience;
       !driver_.closed() && monotonic_now() < end;)
    turn(monotonic_now());
}

void Session::turn(TimePoint now) {
  pump(transport_, driver_, now);
  transport_.wait(std::clamp(driver_.due(), now, now + kTurn) - now, now);
}

void Session::advise() {
  const DriverStatus status = driver_.status();
  if (told_ && status.phase == told_->phase && status.trouble == told_->trouble) return;
  const std::string text = advice(status);
  if (status.phase == Phase::failed) throw std::runtime_error("the Falcon: " + text);
  if (!told_ || text != advice(*told_)) std::fprintf(stderr, "%s\n", text.c_str());
  told_ = status;
}

bool Session::run(Duration most, const std::function<bool(TimePoint)>& done) {
  const TimePoint end = monotonic_now() + most;
  for (TimePoint now = monotonic_now(); now < end; now = monotonic_now()) {
    if (stop_requested()) throw std::runtime_error("stopped");
    turn(now);
    advise();
    if (done(now)) return true;
  }
  return false;
}

void Session::run_samples(int most, const std::function<bool(TimePoint, const Sample&)>& done) {
  constexpr Duration kSlowest = std::chrono::milliseconds(20);  // between two of them
  std::optional<TimePoint> last;
  run(most * kSlowest, [&](TimePoint now) {
    const Phase phase = driver_.status().phase;
    if (phase != Phase::homed && phase != Phase::armed) return true;
    const auto& sample = driver_.sample();
    if (!sample || (last && sample->at == *last)) return false;
    last = sample->at;
    return done(now, *sample) || --most == 0;
  });
}

void Session::reach(Phase phase, Duration most) {
  if (run(most, [&](TimePoint) { return driver_.status().phase == phase; })) return;
  throw std::runtime_error(std::string("the Falcon is not ") + to_string(phase) + " after " +
                           std::to_string(most / std::chrono::seconds(1)) +
                           " s: " + advice(driver_.status()));
}

std::string Session::ask(const std::string& question) {
  std::printf("%s ", question.c_str());
  std::fflush(stdout);
  std::string line;
  run(std::chrono::hours(24), [&](TimePoint) { return read_line(line); });
  return line;
}

}  // namespace farhand::falcon_usb
