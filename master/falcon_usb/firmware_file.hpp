// The firmware image as a file that the user gives. It has no signature by which to know it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace farhand::falcon_usb {

inline constexpr std::size_t kMostFirmwareBytes = 65536;  // known ones have 7324 to 8492

// Throws a sentence if it cannot be read, is empty, or is larger than any image can be.
std::vector<std::byte> load_firmware(const std::filesystem::path& file);

}  // namespace farhand::falcon_usb
