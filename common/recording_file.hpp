// What every recording has in common, whoever writes it: an MCAP file with the scene attached, what
// it was recorded by and when (metadata `farhand`), the names of limits and statuses, protobuf
// channels with their schemas, and poses for viewers at 50 Hz. deploy/docs/recording.md tells of
// all of it. For one thread.
#pragma once

#include <google/protobuf/message.h>

#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "common/mcap_writer.hpp"
#include "common/scene.hpp"
#include "common/time.hpp"

namespace farhand {

// The scene's text is attached under this name.
inline constexpr const char* kSceneAttachment = "scene.textproto";
// Metadata record with what RecordingAbout says.
inline constexpr const char* kAboutMetadata = "farhand";

struct RecordingAbout {
  std::string role;                            // master, slave, loopback
  Duration epoch_minus_monotonic{};            // log time minus the tick's own; 0 in virtual time
  std::map<std::string, std::string> extra{};  // build_info(), and what else there is to say
};

// A program in real time, started now.
RecordingAbout about_program(const std::string& role, std::map<std::string, std::string> extra);

class RecordingFile {
 public:
  // Overwrites `path`. Throws a sentence if it cannot be opened, or is one of `inputs` or the
  // scene.
  RecordingFile(const std::string& path, const Scene& scene, const RecordingAbout& about,
                const std::vector<std::string>& inputs = {});

  // What else a reader should know. Before the first message.
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& map);
  // A channel, the same one when asked again. All channels before the first message.
  std::uint16_t channel(const std::string& topic, const google::protobuf::Descriptor& type);
  void write(std::uint16_t channel, TimePoint now, const google::protobuf::Message& message);
  // foxglove.PoseInFrame and foxglove.FrameTransform.
  void write_pose(std::uint16_t channel, TimePoint now, const char* frame, const Pose& X);
  void write_transform(std::uint16_t channel, TimePoint now, const char* parent, const char* child,
                       const Pose& X);

  // Ends the file; the row of the final table that says how long it is, or what was lost and why.
  std::string end();

 private:
  std::uint64_t log_time(TimePoint now) const noexcept;

  std::string path_;
  Duration epoch_minus_monotonic_;
  McapWriter writer_;
  std::map<std::string, std::uint16_t> schemas_, channels_;
  std::uint64_t messages_ = 0;
  std::string bytes_;
};

// Fifty times a second of log time is enough to look at; ticks that jitter do not slow it down.
class ViewerRate {
 public:
  bool due(TimePoint now) noexcept {
    if (now < next_) return false;
    next_ = now < next_ + kPeriod ? next_ + kPeriod : now + kPeriod;
    return true;
  }

 private:
  static constexpr Duration kPeriod = std::chrono::milliseconds(20);
  TimePoint next_{};
};

// A number to look at: of a float's 24 bits the first `kBits`, to nearest. The rest is noise that
// would only fill the disk.
template <int kBits = 17>
float plotted(double x) noexcept {
  constexpr std::uint32_t kLast = 1u << (24 - kBits);
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(x));
  return std::isfinite(x) ? std::bit_cast<float>((bits + kLast / 2) & ~(kLast - 1))
                          : static_cast<float>(x);
}

// Appends the numbers of a vector or quaternion (w x y z) to a repeated field: as they are to a
// double's, as they are plotted to a float's.
template <typename Number>
void append(google::protobuf::RepeatedField<Number>* to, std::span<const double> from) {
  to->Reserve(to->size() + static_cast<int>(from.size()));
  for (const double x : from) {
    if constexpr (std::is_same_v<Number, float>)
      to->AddAlreadyReserved(plotted(x));
    else
      to->AddAlreadyReserved(x);
  }
}
template <typename Field, int kRows>
void append(Field* to, const Eigen::Matrix<double, kRows, 1>& from) {
  append(to, std::span<const double>(from.data(), kRows));
}
template <typename Field>
void append(Field* to, const Quat& q) {
  append(to, std::array{q.w(), q.x(), q.y(), q.z()});
}

}  // namespace farhand
