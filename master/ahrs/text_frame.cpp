#include <algorithm>
#include <charconv>
#include <numbers>
#include <string_view>

#include "master/ahrs/frame_formats.hpp"

namespace farhand {
namespace {

constexpr std::size_t kMaxSentence = 180, kHexDigits = 2;
constexpr std::string_view kImuHead = "$VNIMU,", kYmrHead = "$VNYMR,";
constexpr std::size_t kImuNumbers = 11, kYmrNumbers = 12;
constexpr double kDegree = std::numbers::pi / 180;

std::string_view characters(Bytes bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

unsigned checksum(std::string_view between) noexcept {
  unsigned sum = 0;
  for (const char c : between) sum ^= static_cast<unsigned char>(c);
  return sum;
}

bool printable(char c) noexcept {
  return c >= ' ' && c <= '~';
}

// Exactly N decimal numbers with commas between; from_chars takes no plus sign.
template <std::size_t N>
bool read_numbers(std::string_view text, std::array<double, N>& numbers) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const bool last = comma == text.size();
    if (last != (i + 1 == N)) return false;
    std::string_view word = text.substr(0, comma);
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), numbers[i]);
    if (error != std::errc{} || end != word.data() + word.size()) return false;
    text.remove_prefix(last ? comma : comma + 1);
  }
  return true;
}

template <std::size_t N>
Vec3 three(const std::array<double, N>& x, std::size_t at) noexcept {
  return {x[at], x[at + 1], x[at + 2]};
}

std::optional<AhrsSample> read_imu(std::string_view text) noexcept {
  std::array<double, kImuNumbers> x{};
  if (!read_numbers(text, x)) return {};
  return AhrsSample{
      .gyro = three(x, 6), .acceleration = three(x, 3), .magnetic = kTeslaPerGauss * three(x, 0)};
}

std::optional<AhrsSample> read_ymr(std::string_view text) noexcept {
  std::array<double, kYmrNumbers> x{};
  if (!read_numbers(text, x)) return {};
  AhrsSample s{
      .gyro = three(x, 9), .acceleration = three(x, 6), .magnetic = kTeslaPerGauss * three(x, 3)};
  s.attitude = Eigen::AngleAxisd(kDegree * x[0], Vec3::UnitZ()) *
               Eigen::AngleAxisd(kDegree * x[1], Vec3::UnitY()) *
               Eigen::AngleAxisd(kDegree * x[2], Vec3::UnitX());
  return s;
}

// The sentence up to its '*', or nothing while it is still to come; empty: there is none.
std::optional<std::string_view> sentence(std::string_view held) noexcept {
  for (std::size_t i = 1; i < std::min(held.size(), kMaxSentence); ++i) {
    if (held[i] == '*') return held.substr(0, i);
    if (!printable(held[i]) || held[i] == '$') return std::string_view{};
  }
  if (held.size() >= kMaxSentence) return std::string_view{};
  return {};
}

class Writer {
 public:
  explicit Writer(FrameBytes to) noexcept
      : begin_(reinterpret_cast<char*>(to.data())), at_(begin_) {}

  void text(std::string_view s) noexcept { at_ = std::copy(s.begin(), s.end(), at_); }
  void vector(const Vec3& v, int decimals) noexcept {
    for (const double x : v) number(x, decimals);
  }
  // Cut where the format's digits end.
  void number(double x, int decimals) noexcept {
    const double held = std::clamp(x, -999.0, 999.0);
    if (!(held < 0)) *at_++ = '+';
    at_ = std::to_chars(at_, at_ + 16, held, std::chars_format::fixed, decimals).ptr;
    *at_++ = ',';
  }
  std::size_t close() noexcept {
    --at_;  // the last comma
    const unsigned sum = checksum({begin_ + 1, static_cast<std::size_t>(at_ - begin_ - 1)});
    constexpr std::string_view kHex = "0123456789ABCDEF";
    const std::array<char, 5> end{'*', kHex[sum >> 4], kHex[sum & 0xf], '\r', '\n'};
    text({end.data(), end.size()});
    return static_cast<std::size_t>(at_ - begin_);
  }

 private:
  char* begin_;
  char* at_;
};

}  // namespace

FrameScan scan_text(Bytes bytes) noexcept {
  const std::string_view held = characters(bytes);
  if (held[0] != '$') return no_frame();
  const auto body = sentence(held);
  if (!body) return more_bytes();
  if (body->empty()) return no_frame();
  const std::size_t size = body->size() + 1 + kHexDigits;
  if (held.size() < size) return more_bytes();
  unsigned sum = 0;
  const char* digits = held.data() + body->size() + 1;
  const auto [end, error] = std::from_chars(digits, digits + kHexDigits, sum, 16);
  if (error != std::errc{} || end != digits + kHexDigits || sum != checksum(body->substr(1)))
    return no_frame();
  std::optional<AhrsSample> sample;
  if (body->starts_with(kImuHead)) sample = read_imu(body->substr(kImuHead.size()));
  if (body->starts_with(kYmrHead)) sample = read_ymr(body->substr(kYmrHead.size()));
  return sample ? framed(size, *sample) : FrameScan{.kind = FrameScan::Kind::frame, .size = size};
}

std::size_t encode_text(const AhrsSample& s, FrameBytes to) noexcept {
  Writer out(to);
  out.text(kImuHead);
  out.vector(s.magnetic.value_or(Vec3::Zero()) / kTeslaPerGauss, 4);
  out.vector(s.acceleration, 3);
  out.vector(s.gyro, 6);
  out.number(25, 1);
  out.number(101.325, 3);
  return out.close();
}

}  // namespace farhand
