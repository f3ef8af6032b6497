// farhand-observe: looks at a running slave, and can do nothing else.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <optional>

#include "common/arguments.hpp"
#include "common/channel.hpp"
#include "common/mode.hpp"
#include "common/observers.hpp"
#include "common/program.hpp"
#include "common/realtime.hpp"
#include "common/secure_channel.hpp"
#include "common/status_line.hpp"
#include "proto/observe.pb.h"

namespace farhand {
namespace {

struct Options {
  std::string scene;
  std::optional<std::string> slave;
  double duration_s = 0;
};

// Questions out, statuses in.
class Window {
 public:
  Window(const UdpAddress& slave, SecureChannel* secure)
      : socket_({.v6 = slave.v6}, slave), secure_(secure) {}

  void ask() {
    send_handshake(secure_, socket_);
    const auto payload = question();
    const std::size_t size =
        secure_ != nullptr ? secure_->seal(payload, datagram_) : seal(payload, datagram_);
    socket_.send(std::span(datagram_).first(size));
  }
  // The newest one that came by `until`.
  std::optional<proto::Shown> newest(TimePoint until) {
    std::optional<proto::Shown> out;
    while (monotonic_now() < until && socket_.wait_readable(until))
      if (const auto got = socket_.receive(datagram_))
        take(std::span(datagram_).first(got->size), out);
    return out;
  }

 private:
  void take(std::span<const std::byte> datagram, std::optional<proto::Shown>& out) {
    if (secure_ != nullptr && secure_->take(datagram, *socket_.peer())) return;
    const Opened opened =
        secure_ != nullptr ? secure_->open(datagram, payload_) : open(datagram, payload_);
    proto::Shown shown;
    if (opened.verdict == Verdict::accepted && payload_[0] == kAnswer &&
        shown.ParsePartialFromArray(&payload_[1], static_cast<int>(opened.size - 1)))
      out = shown;
  }

  UdpSocket socket_;
  SecureChannel* secure_;
  std::array<std::byte, UdpSocket::kReceiveBytes> datagram_{};
  std::array<std::byte, kMaxPayloadBytes> payload_{};
};

std::string live_line(const proto::Shown& s) {
  const auto& p = s.position_tool_in_slave_m();
  const auto& F = s.force_on_environment_newton();
  return fmt::format(
      "{:<7} tool ({:6.1f} {:6.1f} {:6.1f}) mm  contact {:5.2f} N  jitter {:6.1f} us  lost {}  "
      "dropped {}",
      to_string(static_cast<Mode>(s.mode())), p[0] * 1e3, p[1] * 1e3, p[2] * 1e3,
      Vec3(F[0], F[1], F[2]).norm(), s.jitter_us(), s.lost(), s.dropped());
}

bool whole(const proto::Shown& s) {
  return s.IsInitialized() && s.mode() < kModes && s.reason() < kReasons &&
         s.position_tool_in_slave_m_size() == 3 && s.force_on_environment_newton_size() == 3;
}

// What is told once, when it begins.
class Teller {
 public:
  explicit Teller(std::uint64_t scene_hash) : scene_hash_(scene_hash), line_(false) {}

  void silence(TimePoint now) {
    constexpr Duration kPatience = std::chrono::seconds(3);
    if (!heard_) heard_ = now;
    if (silent_ || now - *heard_ < kPatience) return;
    silent_ = true;
    line_.end();
    spdlog::warn(
        "no answer from the slave: is it running, with this observer_address and the same key or "
        "authority?");
  }
  void tell(const proto::Shown& s, TimePoint now) {
    heard_ = now;
    silent_ = false;
    if (s.protocol_version() != kProtocolVersion || !whole(s)) return other_version(s);
    if (!told_scene_ && s.scene_hash() != scene_hash_)
      spdlog::warn("the slave runs another scene (shared part {:016x}, here {:016x})",
                   s.scene_hash(), scene_hash_);
    told_scene_ = true;
    if (!mode_ || *mode_ != s.mode() || reason_ != s.reason()) change(s);
    if (line_.due(now)) line_.show(live_line(s));
  }
  void end() { line_.end(); }

 private:
  void other_version(const proto::Shown& s) {
    if (!told_version_)
      spdlog::error(
          "the slave speaks protocol version {}, this program {}: install the same version",
          s.protocol_version(), kProtocolVersion);
    told_version_ = true;
  }
  void change(const proto::Shown& s) {
    line_.end();
    const char* why = to_string(static_cast<Reason>(s.reason()));
    spdlog::info("{}{}{}", to_string(static_cast<Mode>(s.mode())), *why != 0 ? ": " : "", why);
    mode_ = s.mode();
    reason_ = s.reason();
  }

  std::uint64_t scene_hash_;
  StatusLine line_;
  std::optional<TimePoint> heard_;
  bool silent_ = false, told_scene_ = false, told_version_ = false;
  std::optional<std::uint32_t> mode_;
  std::uint32_t reason_ = 0;
};

int observe(const Options& options) {
  constexpr Duration kPace = std::chrono::milliseconds(50);
  const Scene scene = load_scene(options.scene);
  if (!options.slave && !scene.proto.link().has_observer_address())
    throw std::runtime_error(scene.path +
                             " lets nobody look: say link { observer_address: \"...\" } on the "
                             "slave's side and here, or give --slave");
  const UdpAddress slave =
      link_address(options.slave, scene.proto.link().observer_address(), scene);
  const auto secure = make_secure(scene, slave);
  Window window(slave, secure ? &secure->channel() : nullptr);
  Teller teller(scene.shared_hash);
  spdlog::info("looks at {}{}", to_string(slave), with_credentials(secure.get()));
  catch_stop_signals();
  const TimePoint end =
      monotonic_now() + (options.duration_s > 0 ? from_seconds(options.duration_s)
                                                : Duration(std::chrono::hours(24 * 365)));
  for (TimePoint now = monotonic_now(); now < end && !stop_requested(); now = monotonic_now()) {
    window.ask();
    if (const auto shown = window.newest(now + kPace))
      teller.tell(*shown, now);
    else
      teller.silence(now);
  }
  teller.end();
  return 0;
}

}  // namespace
}  // namespace farhand

int main(int argc, char** argv) {
  using namespace farhand;
  Options options;
  Arguments arguments("looks at a running slave", "farhand-observe");
  arguments.option("scene", options.scene, "the slave's scene");
  arguments.option("--slave", options.slave, "host:port, instead of the scene's observer_address");
  arguments.duration(options.duration_s, "stop after so many seconds");
  const auto missing = [&] { return options.scene.empty() ? "scene" : ""; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  return run_guarded("farhand-observe", [&] { return observe(options); });
}
