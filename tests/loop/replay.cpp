#include "tests/loop/replay.hpp"

#include <spdlog/spdlog.h>

#include <charconv>

#include "common/mcap_reader.hpp"
#include "master/record.hpp"

namespace farhand {
namespace {

constexpr const char* kSeed = "seed";
constexpr const char* kDuration = "duration_s";

// Nothing if the recording does not say it, or not as a number.
template <typename T>
std::optional<T> said(const McapReader& reader, const char* key) {
  const auto about = reader.metadata().find(kAboutMetadata);
  if (about == reader.metadata().end() || !about->second.contains(key)) return {};
  const std::string& text = about->second.at(key);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

Scene scene_of(const McapReader& reader, const std::string& recording, const std::string& scene) {
  if (!scene.empty()) return load_scene(scene);
  const auto attached = reader.attachments().find(kSceneAttachment);
  if (attached == reader.attachments().end())
    throw std::runtime_error(recording + " has no scene attached: give a scene file too");
  return parse_scene(attached->second, recording + "/" + kSceneAttachment);
}

}  // namespace

Scene prepare_replay(const std::string& recording, const std::string& scene,
                     LoopbackOptions& options) {
  McapReader reader(recording);
  ReplayHand hand(read_readings(reader));
  for (const auto& what : reader.damage()) spdlog::warn("{}: {}", recording, what);
  if (!reader.complete()) spdlog::warn("{} is cut off, {} ticks are left", recording, hand.size());

  Scene out = scene_of(reader, recording, scene);
  const double length = static_cast<double>(hand.size()) / out.proto.rate_hz();
  if (!options.seed) options.seed = said<std::uint64_t>(reader, kSeed);
  if (!options.duration_s) options.duration_s = said<double>(reader, kDuration).value_or(length);
  options.device.emplace(std::move(hand));
  return out;
}

RecordingAbout about_loopback(const Scene& scene, const LoopbackOptions& options,
                              std::map<std::string, std::string> extra) {
  extra[kSeed] = std::to_string(options.seed.value_or(scene.proto.seed()));
  extra[kDuration] = fmt::format("{}", options.duration_s.value_or(scene.proto.duration_s()));
  return {.role = "loopback", .extra = std::move(extra)};
}

}  // namespace farhand
