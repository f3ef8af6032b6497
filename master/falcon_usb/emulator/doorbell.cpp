#include "master/falcon_usb/emulator/doorbell.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace farhand::falcon_usb {
namespace {

constexpr int kPipeBytes = 4096;  // the least there is

}  // namespace

Doorbell::Doorbell(const std::string& path) : pipe_(path) {
  fcntl(pipe_.file(), F_SETPIPE_SZ, kPipeBytes);
  quiet();
}

void Doorbell::ring() noexcept {
  if (std::exchange(rings_, true)) return;
  std::array<char, kPipeBytes> bytes;
  while (read(pipe_.file(), bytes.data(), bytes.size()) > 0) {
  }
}

void Doorbell::quiet() noexcept {
  if (!std::exchange(rings_, false)) return;
  constexpr std::array<char, kPipeBytes> kBytes{};
  while (write(pipe_.file(), kBytes.data(), kBytes.size()) > 0) {
  }
}

}  // namespace farhand::falcon_usb
