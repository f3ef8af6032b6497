#include "master/recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace farhand {
namespace {

constexpr std::string_view kPosition = "t_s,x_m,y_m,z_m";
constexpr std::string_view kRotation = ",qw,qx,qy,qz";
constexpr std::string_view kForce = ",fx_n,fy_n,fz_n";
constexpr std::size_t kMostColumns = 11;
constexpr double kLargestNumber = 1e6;  // far beyond any metre, second or newton of a hand

struct Columns {
  bool rotation = false;
  std::size_t count = 4;
};

// Where the reader stands, for its complaints.
struct Place {
  const std::string& file;
  std::size_t line = 0;  // 0: the file as a whole

  [[noreturn]] void refuse(const std::string& why) const {
    throw std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + why);
  }
};

Columns read_header(std::string_view header, const Place& place) {
  Columns columns;
  std::string_view rest = header;
  const auto take = [&rest](std::string_view part) {
    if (!rest.starts_with(part)) return false;
    rest.remove_prefix(part.size());
    return true;
  };
  const bool position = take(kPosition);
  columns.rotation = take(kRotation);
  columns.count += (columns.rotation ? 4 : 0) + (take(kForce) ? 3 : 0);
  if (!position || !rest.empty())
    place.refuse("the header is not " + std::string(kPosition) + "[" + std::string(kRotation) +
                 "][" + std::string(kForce) + "]; name the columns so and give SI units");
  return columns;
}

std::array<double, kMostColumns> read_row(std::string_view text, std::size_t count,
                                          const Place& place) {
  std::array<double, kMostColumns> row{};
  const auto commas = static_cast<std::size_t>(std::count(text.begin(), text.end(), ','));
  if (commas + 1 != count)
    place.refuse(std::to_string(commas + 1) + " columns where the header has " +
                 std::to_string(count) + "; complete the row or remove it");
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view cell = text.substr(0, text.find(','));
    const char* const end = cell.data() + cell.size();
    const auto [stop, error] = std::from_chars(cell.data(), end, row[i]);
    if (error != std::errc{} || stop != end || !(std::abs(row[i]) <= kLargestNumber))
      place.refuse("'" + std::string(cell) +
                   "' is not a number up to 1e6; write decimals with a point, or remove the row");
    text.remove_prefix(std::min(text.size(), cell.size() + 1));
  }
  return row;
}

Quat unit_quaternion(const double* wxyz, const Recording& so_far, const Place& place) {
  Quat q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (std::abs(q.norm() - 1) > 0.01)
    place.refuse("the quaternion's length is " + std::to_string(q.norm()) + "; it must be 1");
  q.normalize();
  if (!so_far.q.empty() && q.dot(so_far.q.back()) < 0) q.coeffs() = -q.coeffs();
  return q;
}

void check_time(double t, const Recording& so_far, const Place& place) {
  if (so_far.t.empty()) return;
  if (t <= so_far.t.back())
    place.refuse("t_s does not increase; sort the rows and drop repeated times");
  if (t > kLongestRecording)
    place.refuse("the recording lasts more than " +
                 std::to_string(static_cast<int>(kLongestRecording)) + " s; cut it");
}

bool next_line(std::istream& in, std::string& line, Place& place) {
  if (!std::getline(in, line)) return false;
  ++place.line;
  if (line.ends_with('\r')) line.pop_back();
  return true;
}

}  // namespace

Recording read_recording(const std::string& file) {
  Place place{file};
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) place.refuse("cannot be opened as a file; give the path of a recorded motion");
  if (bytes > kLargestRecording)
    place.refuse("the file has more than " + std::to_string(kLargestRecording >> 20) +
                 " MB; cut it or thin it out");

  std::string line;
  next_line(in, line, place);
  const Columns columns = read_header(line, place);
  Recording recording;
  double start = 0;
  while (next_line(in, line, place)) {
    const auto row = read_row(line, columns.count, place);
    if (recording.t.empty()) start = row[0];
    check_time(row[0] - start, recording, place);
    recording.t.push_back(row[0] - start);
    recording.p.emplace_back(row[1], row[2], row[3]);
    if (columns.rotation) recording.q.push_back(unit_quaternion(row.data() + 4, recording, place));
  }
  if (recording.t.size() < 2) place.refuse("fewer than two rows; a motion needs at least two");
  return recording;
}

}  // namespace farhand
