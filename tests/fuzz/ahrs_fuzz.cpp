// An AHRS line says whatever the fuzzer says. The first byte chooses the format, then a piece is
//
//   what: below 192 raw bytes (size, bytes)   |   else a good frame: six words, where it is cut
//
// Whatever went before it costs a good frame nothing, but in the format whose checksum of 16 bits
// the fuzzer can guess.
#include "master/ahrs/frames.hpp"
#include "tests/fuzz/input.hpp"

namespace farhand {
namespace {

struct Bench {
  AhrsFormat format;
  AhrsParser parser{format};
  std::size_t pushed = 0, given = 0;
  std::optional<AhrsSample> last{};

  void push(std::span<const std::byte> bytes) {
    pushed += bytes.size();
    bool fed = false;
    const auto more = [&] {
      const auto now = fed ? std::span<const std::byte>{} : bytes;
      fed = true;
      return now;
    };
    while (const auto sample = next_sample(parser, more)) {
      require(plausible(*sample));
      require(!sample->attitude || std::abs(sample->attitude->norm() - 1) < 1e-9);
      last = sample;
      ++given;
    }
    require(fed);
    require(parser.samples() == given);
    require(parser.skipped() <= pushed);
  }
};

void good_frame(Bench& bench, Input& input) {
  AhrsSample sent;
  for (double& x : sent.gyro) x = (input.number() - 32768.0) / 1024;
  for (double& x : sent.acceleration) x = (input.number() - 32768.0) / 512;
  std::array<std::byte, kMaxFrameBytes> frame{};
  const std::size_t size = encode(sent, bench.format, frame);
  const std::size_t cut = std::min<std::size_t>(input.byte(), size);
  bench.last.reset();
  bench.push(std::span(frame).first(cut));
  bench.push(std::span(frame).subspan(cut, size - cut));
  // What stands before may have asked for more bytes than have come.
  bench.push(std::array<std::byte, kMaxFrameBytes>{});
  if (bench.format == AhrsFormat::vectornav) return;
  constexpr double kDigits = 1e-3;  // of a text
  require(bench.last.has_value());
  require((bench.last->gyro - sent.gyro).cwiseAbs().maxCoeff() <= kDigits);
  require((bench.last->acceleration - sent.acceleration).cwiseAbs().maxCoeff() <= kDigits);
}

}  // namespace
}  // namespace farhand

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace farhand;
  Input input(data, size);
  Bench bench{static_cast<AhrsFormat>(input.byte() % 3)};
  while (!input.empty()) {
    if (input.byte() < 192)
      bench.push(input.take(input.byte()));
    else
      good_frame(bench, input);
  }
  return 0;
}
