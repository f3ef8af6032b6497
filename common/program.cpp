#include "common/program.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <random>

#include "common/address.hpp"
#include "common/arguments.hpp"
#include "common/doctor.hpp"
#include "common/scene_credentials.hpp"
#include "common/scene_realtime.hpp"

namespace farhand {
namespace {

void add_options(Arguments& arguments, ProgramOptions& options, bool is_master) {
  arguments.option("scene", options.scene, "scene file, see deploy/scenes");
  arguments.flag("--plan", options.plan, "print the stages this scene runs, in order, and exit");
  arguments.flag("--check", options.check, "check the scene and exit");
  arguments.flag(
      "--doctor", options.doctor,
      "tell whether this machine is fit to run the scene, and what to do where it is not");
  arguments.flag("--quiet", options.quiet, "no live status line");
  arguments.duration(options.duration_s, "stop after so many seconds");
  arguments.option("--record", options.record, "record every tick into this MCAP file");
  arguments.option("--listen", options.listen, "host:port to listen on, instead of the scene's");
  if (!is_master) return;
  arguments.option("--slave", options.slave, "host:port of the slave, instead of the scene's");
  arguments.flag("--take-over", options.take_over,
                 "lead in the place of the master that leads now");
  arguments.option("--trace", options.trace, "recorded motion (CSV) for the simulated hand");
}

}  // namespace

int run_guarded(const std::string& name, const std::function<int()>& body) {
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
  spdlog::set_pattern("[%H:%M:%S] %n: %^%l%$: %v");
  try {
    return body();
  } catch (const SceneError& e) {
    std::fprintf(stderr, "%s\n", e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), e.what());
  }
  return 1;
}

int run_program(int argc, char** argv, const std::string& name, const std::string& description,
                const std::function<int(const ProgramOptions&)>& body, const doctor::Look& more) {
  Arguments arguments(description, name);
  ProgramOptions options;
  const bool is_master = name == "farhand-master";
  add_options(arguments, options, is_master);
  const auto missing = [&] { return options.scene.empty() ? "scene" : ""; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  catch_stop_signals();
  const std::string side = is_master ? "master" : "slave";
  return run_guarded(
      name, [&] { return options.doctor ? doctor::run(side, options, more) : body(options); });
}

bool print_only(const ProgramOptions& options, const Scene& scene, const Stages& stages) {
  if (options.plan) {
    for (const auto& [side, lines] : stages) {
      std::printf("%s\n", side.c_str());
      int number = 1;
      for (const auto& line : lines) std::printf("  %2d  %s\n", number++, line.c_str());
    }
  } else if (options.check) {
    std::printf("%s: good (shared part %016llx)\n", scene.path.c_str(),
                static_cast<unsigned long long>(scene.shared_hash));
  }
  return options.plan || options.check;
}

void require_slave(const Scene& scene) {
  if (!scene.proto.has_slave())
    throw std::runtime_error(scene.path +
                             " has no slave: run it with farhand-master or farhand-loopback alone");
}

void refuse_addresses(const ProgramOptions& options, const Scene& scene) {
  const char* flag = options.slave       ? "--slave"
                     : options.listen    ? "--listen"
                     : options.take_over ? "--take-over"
                                         : nullptr;
  if (flag != nullptr)
    throw std::runtime_error(scene.path + " has no slave to talk to: leave out " + flag);
}

UdpAddress link_address(const std::optional<std::string>& flag, const std::string& scenes,
                        const Scene& scene) {
  const std::string& text = flag ? *flag : scenes;
  const auto address = parse_address(text);
  const auto& link = scene.proto.link();
  if (address && !address->loopback && !has_credentials(link) && !link.insecure())
    throw std::runtime_error(
        text +
        " reaches beyond this machine, and plain datagrams are neither encrypted nor "
        "authenticated: make a key with farhand-keygen and say link { key_file: \"...\" } in the "
        "scene, or insecure: true if the network is your own");
  return parse_udp_address(text);
}

std::unique_ptr<SecureService> make_secure(const Scene& scene,
                                           const std::optional<UdpAddress>& server) {
  const auto role = server ? DtlsRole::client : DtlsRole::server;
  if (const auto credentials = link_credentials(scene, role))
    return std::make_unique<SecureService>(SecureChannelConfig{.server = server}, *credentials);
  if (scene.proto.link().insecure())
    spdlog::warn(
        "the link is insecure: whoever reaches its port can move the robot; make a key with "
        "farhand-keygen and name it in the scene instead: link {{ key_file: \"...\" }}");
  return nullptr;
}

std::string with_credentials(const SecureService* secure) {
  return secure == nullptr ? "" : ", " + secure->credentials();
}

void start_realtime(const proto::Realtime& realtime, bool real_device, int priority) {
  const RealtimeConfig config = realtime_config(realtime);
  const auto refused = enter_realtime(config, priority);
  warn_each(refused);
  if (const auto why = degraded_refusal(real_device, refused, config.allow_degraded))
    throw std::runtime_error(*why);
}

void announce(const Scene& scene, const std::string& where) {
  spdlog::info("runs {} at {:g} Hz, {}", scene.path, scene.proto.rate_hz(), where);
}

void warn_each(const std::vector<std::string>& sentences) {
  for (const auto& s : sentences) spdlog::warn("{}", s);
}

std::uint64_t random_session() {
  std::random_device source;
  std::uint64_t session = 0;
  while (session == 0) session = (std::uint64_t{source()} << 32) | source();
  return session;
}

}  // namespace farhand
