#include "master/falcon_usb/firmware_file.hpp"

#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

namespace farhand::falcon_usb {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
  throw std::runtime_error("firmware file " + file.string() + " " + why +
                           "; give the Falcon's image, such as nvent_firmware.bin");
}

}  // namespace

std::vector<std::byte> load_firmware(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) refuse(file, "cannot be read");
  std::string text(kMostFirmwareBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.empty()) refuse(file, "is empty");
  if (text.size() > kMostFirmwareBytes) refuse(file, "is larger than 64 KiB");
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace farhand::falcon_usb
