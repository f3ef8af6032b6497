#include "common/recording_file.hpp"

#include <google/protobuf/descriptor.pb.h>
#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <set>
#include <stdexcept>

#include "common/limits.hpp"
#include "common/realtime.hpp"
#include "common/status.hpp"
#include "proto/foxglove.pb.h"

namespace farhand {
namespace {

// Never opens what the run reads: writing begins by emptying the file.
const std::string& checked(const std::string& path, const std::vector<std::string>& inputs) {
  for (const auto& input : inputs) {
    std::error_code none;
    if (std::filesystem::equivalent(path, input, none))
      throw std::runtime_error(path + " is read by this run: give another file to record into");
  }
  return path;
}

std::vector<std::string> with(std::vector<std::string> inputs, const std::string& scene) {
  inputs.push_back(scene);
  return inputs;
}

// Every file before those that import it.
void add_file(const google::protobuf::FileDescriptor& file, std::set<std::string>& added,
              google::protobuf::FileDescriptorSet& out) {
  if (!added.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), added, out);
  file.CopyTo(out.add_file());
}

std::string schema_of(const google::protobuf::Descriptor& type) {
  std::set<std::string> added;
  google::protobuf::FileDescriptorSet files;
  add_file(*type.file(), added, files);
  return files.SerializeAsString();
}

std::string library(const RecordingAbout& about) {
  const auto version = about.extra.find("version");
  return version == about.extra.end() ? "farhand" : "farhand " + version->second;
}

mcap::TextMap limit_names() {
  mcap::TextMap names;
  for (int bit = 0; bit < kLimitCount; ++bit) names[std::to_string(bit)] = limit_name(bit);
  return names;
}

mcap::TextMap status_names() {
  mcap::TextMap names;
  for (int s = 0; s <= static_cast<int>(Status::out_of_limits); ++s)
    names[std::to_string(s)] = to_string(static_cast<Status>(s));
  return names;
}

mcap::TextMap about_map(const RecordingAbout& about, const Scene& scene) {
  mcap::TextMap map = about.extra;
  map["role"] = about.role;
  map["scene_hash"] = fmt::format("{:016x}", scene.shared_hash);
  map["scene_path"] = scene.path;
  map["epoch_minus_monotonic_ns"] = std::to_string(about.epoch_minus_monotonic.count());
  return map;
}

void set_time(google::protobuf::Timestamp& to, std::uint64_t ns) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  to.set_seconds(static_cast<std::int64_t>(ns / kSecond));
  to.set_nanos(static_cast<std::int32_t>(ns % kSecond));
}
void set(foxglove::Vector3& to, const Vec3& p) {
  to.set_x(p.x()), to.set_y(p.y()), to.set_z(p.z());
}
void set(foxglove::Quaternion& to, const Quat& q) {
  to.set_x(q.x()), to.set_y(q.y()), to.set_z(q.z()), to.set_w(q.w());
}

}  // namespace

RecordingAbout about_program(const std::string& role, std::map<std::string, std::string> extra) {
  return {role,
          std::chrono::system_clock::now().time_since_epoch() - monotonic_now().time_since_epoch(),
          std::move(extra)};
}

RecordingFile::RecordingFile(const std::string& path, const Scene& scene,
                             const RecordingAbout& about, const std::vector<std::string>& inputs)
    : path_(checked(path, with(inputs, scene.path))),
      epoch_minus_monotonic_(about.epoch_minus_monotonic),
      writer_(path, library(about)) {
  writer_.add_metadata(kAboutMetadata, about_map(about, scene));
  writer_.add_metadata("limits", limit_names());
  writer_.add_metadata("status", status_names());
  writer_.add_attachment(kSceneAttachment, "text/plain", scene.text);
}

void RecordingFile::add_metadata(const std::string& name,
                                 const std::map<std::string, std::string>& map) {
  writer_.add_metadata(name, map);
}

std::uint16_t RecordingFile::channel(const std::string& topic,
                                     const google::protobuf::Descriptor& type) {
  constexpr const char* kEncoding = "protobuf";
  std::uint16_t& schema = schemas_[type.full_name()];
  if (schema == 0) schema = writer_.add_schema(type.full_name(), kEncoding, schema_of(type));
  std::uint16_t& channel = channels_[topic];
  if (channel == 0) channel = writer_.add_channel(topic, schema, kEncoding);
  return channel;
}

void RecordingFile::write(std::uint16_t channel, TimePoint now,
                          const google::protobuf::Message& message) {
  message.SerializeToString(&bytes_);
  writer_.write(channel, log_time(now), bytes_);
  ++messages_;
}

void RecordingFile::write_pose(std::uint16_t channel, TimePoint now, const char* frame,
                               const Pose& X) {
  foxglove::PoseInFrame message;
  set_time(*message.mutable_timestamp(), log_time(now));
  message.set_frame_id(frame);
  set(*message.mutable_pose()->mutable_position(), X.p);
  set(*message.mutable_pose()->mutable_orientation(), to_quat(X.R));
  write(channel, now, message);
}

void RecordingFile::write_transform(std::uint16_t channel, TimePoint now, const char* parent,
                                    const char* child, const Pose& X) {
  foxglove::FrameTransform message;
  set_time(*message.mutable_timestamp(), log_time(now));
  message.set_parent_frame_id(parent);
  message.set_child_frame_id(child);
  set(*message.mutable_translation(), X.p);
  set(*message.mutable_rotation(), to_quat(X.R));
  write(channel, now, message);
}

std::uint64_t RecordingFile::log_time(TimePoint now) const noexcept {
  return static_cast<std::uint64_t>((now.time_since_epoch() + epoch_minus_monotonic_).count());
}

std::string RecordingFile::end() {
  writer_.close();
  const std::string row =
      fmt::format("  recorded {} messages, {:.1f} MB into {}\n", messages_ - writer_.lost(),
                  static_cast<double>(writer_.file_bytes()) * 1e-6, path_);
  if (writer_.error().empty()) return row;
  return row + fmt::format("  recording lost {} of {} messages: {}\n", writer_.lost(), messages_,
                           writer_.error());
}

}  // namespace farhand
