#include "common/doctor_link.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "common/scene_credentials.hpp"

namespace farhand::doctor {
namespace {

// Of the message's oneof, by its name in a scene; `none` where nothing is chosen.
std::string chosen(const google::protobuf::Message& m, const char* oneof, const char* none) {
  const auto* choice = m.GetDescriptor()->FindOneofByName(oneof);
  const auto* field =
      choice == nullptr ? nullptr : m.GetReflection()->GetOneofFieldDescriptor(m, choice);
  return field == nullptr ? none : field->name();
}

std::string methods(const proto::Scene& s) {
  const std::string master =
      fmt::format("handle {}, device {}", chosen(s.master(), "handle", "none"),
                  chosen(s.master(), "device", "sim_hand"));
  if (!s.has_slave()) return master + ", no slave";
  return fmt::format("{}, robot {}, architecture {}, compensation {}", master,
                     chosen(s.slave(), "robot", "sim_arm"),
                     chosen(s.bilateral(), "architecture", "position_force"),
                     chosen(s.compensation(), "method", "none"));
}

UdpSocket open_socket(bool is_master, const ProgramOptions& options, const Scene& scene) {
  const auto& link = scene.proto.link();
  if (!is_master) {
    if (link.has_observer_address()) UdpSocket(link_address({}, link.observer_address(), scene));
    return UdpSocket(link_address(options.listen, link.slave_address(), scene));
  }
  return UdpSocket(link_address(options.listen, link.master_address(), scene),
                   link_address(options.slave, link.slave_address(), scene));
}

}  // namespace

Finding scene_file(const std::string& path, std::optional<Scene>& to) {
  try {
    to = load_scene(path);
  } catch (const std::exception& e) {
    return {Level::problem, "scene", e.what()};
  }
  return {
      Level::ok, "scene",
      fmt::format("{}: good (shared part {:016x}); {}", path, to->shared_hash, methods(to->proto))};
}

Findings link(const std::string& side, const ProgramOptions& options, const Scene& scene) {
  const bool is_master = side == "master";
  const auto role = is_master ? DtlsRole::client : DtlsRole::server;
  try {
    if (!is_master) require_slave(scene);
    if (!scene.proto.has_slave()) {
      refuse_addresses(options, scene);
      return {{Level::ok, "address", "none: this scene has no slave"}};
    }
    const UdpSocket socket = open_socket(is_master, options, scene);
    const std::string peer =
        socket.peer() ? ", the slave's is " + to_string(*socket.peer()) : std::string();
    return {{Level::ok, "address", to_string(socket.local()) + " can be bound" + peer},
            receive_buffer(socket.receive_buffer(), scene.proto),
            credentials(scene, role)};
  } catch (const std::exception& e) {
    return {{Level::problem, "address", e.what()}, credentials(scene, role)};
  }
}

// What the kernel counts for the largest datagram: its memory comes in pieces of two KiB.
Finding receive_buffer(std::size_t bytes, const proto::Scene& scene) {
  constexpr double kEach = 2304;
  const double ms = 1e3 * static_cast<double>(bytes) / kEach / scene.rate_hz();
  const double stale = scene.link().stale_ms();
  const std::string text = fmt::format("{} bytes hold the messages of {:.0f} ms", bytes, ms);
  if (ms >= stale) return {Level::ok, "receive buffer", text};
  return {Level::warning, "receive buffer",
          text + fmt::format(", less than stale_ms: sysctl net.core.rmem_default={:.0f}",
                             std::ceil(stale * 1e-3 * scene.rate_hz() * kEach))};
}

namespace {

constexpr int kDaysOfWarning = 30;

Finding certificates(const Scene& scene, DtlsRole role) {
  const CertificateFiles files = certificate_files(scene);
  const Certificates own = load_certificates(files, role);
  const std::time_t until = valid_until(own);
  const std::string text =
      fmt::format("{} in {}, valid until {}", own.name, files.certificate.string(), date(until));
  const double days = std::difftime(until, std::time(nullptr)) / (24 * 3600);
  if (days > kDaysOfWarning) return {Level::ok, "certificate", text};
  return {Level::warning, "certificate",
          text + fmt::format(", {:.0f} days from now: make new ones for both sides with "
                             "farhand-keygen --certificates",
                             std::floor(days))};
}

}  // namespace

Finding credentials(const Scene& scene, DtlsRole role) {
  const auto& l = scene.proto.link();
  if (l.insecure())
    return {Level::warning, "key",
            "none, and the link says insecure: whoever reaches its port can move the robot; make "
            "a key with farhand-keygen and say key_file: \"...\" instead"};
  if (!has_credentials(l)) return {Level::ok, "key", "none: the link does not leave this machine"};
  try {
    if (l.has_certificates()) return certificates(scene, role);
    return {Level::ok, "key", load_key(key_path(scene)).name + " in " + key_path(scene).string()};
  } catch (const std::exception& e) {
    return {Level::problem, l.has_certificates() ? "certificate" : "key", e.what()};
  }
}

}  // namespace farhand::doctor
