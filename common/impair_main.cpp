// farhand-impair: a bad network between two programs, over UDP.
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <stdexcept>

#include "common/arguments.hpp"
#include "common/program.hpp"
#include "common/realtime.hpp"
#include "common/relay.hpp"
#include "common/scene_network.hpp"

namespace farhand {
namespace {

struct Options {
  std::optional<std::string> listen, to, scene, both, to_server, to_client;
  std::optional<std::uint64_t> seed;
  double duration_s = 0;
};

struct FirstError : google::protobuf::io::ErrorCollector {
  void AddError(int, int column, const std::string& what) override {
    if (text.empty()) text = what + " (column " + std::to_string(column + 1) + ")";
  }
  std::string text;
};

ImpairmentConfig parse(const std::string& argument, const std::string& text) {
  proto::Impairment out;
  FirstError error;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&error);
  if (!parser.ParseFromString(text, &out))
    throw std::invalid_argument(
        argument + " '" + text + "': " + error.text +
        "; write fields of message Impairment in proto/scene_link.proto, such "
        "as 'delay_ms: 25 jitter_ms: 3 loss_ratio: 0.01'");
  if (out.blackout_size() > 8)
    throw std::invalid_argument(argument + ": more than 8 blackouts; give one with a period_s");
  return impairment_config(out);
}

UdpAddress address(const std::string& argument, const std::string& text) {
  try {
    return parse_udp_address(text);
  } catch (const std::exception& e) {
    throw std::invalid_argument(argument + ": " + e.what());
  }
}

RelayConfig relay_config(const Options& options) {
  RelayConfig out{.listen = address("--listen", *options.listen),
                  .server = address("--to", *options.to)};
  if (out.server.port == 0)
    throw std::invalid_argument("--to has port 0; give the port on which the slave listens");
  if (options.scene) {
    const Scene scene = load_scene(*options.scene);
    out.to_server = to_slave_config(scene.proto.link());
    out.to_client = to_master_config(scene.proto.link());
    out.seed = scene.proto.seed();
  }
  if (options.both) out.to_server = out.to_client = parse("--both", *options.both);
  if (options.to_server) out.to_server = parse("--to-slave", *options.to_server);
  if (options.to_client) out.to_client = parse("--to-master", *options.to_client);
  out.seed = options.seed.value_or(out.seed);
  return out;
}

int relay(const Options& options) {
  const RelayConfig config = relay_config(options);
  Relay relay(config);
  spdlog::info("listens on {}, passes on to {}, seed {}", to_string(relay.local()),
               to_string(config.server), config.seed);
  catch_stop_signals();
  const Duration limit = options.duration_s > 0 ? from_seconds(options.duration_s)
                                                : Duration(std::chrono::hours(24 * 365));
  const TimePoint end = monotonic_now() + limit;
  for (TimePoint now = monotonic_now(); now < end && !stop_requested(); now = monotonic_now()) {
    relay.forward(now);
    relay.wait(std::min(end, now + std::chrono::milliseconds(50)));
  }
  std::fputs(("relay\n" + relay.summary()).c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace farhand

int main(int argc, char** argv) {
  using namespace farhand;
  Options options;
  Arguments arguments("a bad network between master and slave, over UDP", "farhand-impair");
  arguments.option("--listen", options.listen, "host:port to which the master sends");
  arguments.option("--to", options.to, "host:port of the slave");
  arguments.option("--scene", options.scene, "take both ways from this scene's link");
  arguments.option("--both", options.both, "impairment of both ways, as a scene writes it");
  arguments.option("--to-slave", options.to_server, "of the way to the slave alone");
  arguments.option("--to-master", options.to_client, "of the way to the master alone");
  arguments.option("--seed", options.seed, "of losses and jitter");
  arguments.duration(options.duration_s, "stop after so many seconds");
  const auto missing = [&] { return !options.listen ? "--listen" : !options.to ? "--to" : ""; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  return run_guarded("farhand-impair", [&] { return relay(options); });
}
