// A serial line for reading, eight bits, no parity, one stop bit, as bytes without blocking.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

namespace farhand {

class SerialPort {
 public:
  // Throws std::runtime_error with a sentence: the path cannot be opened, is no serial line, or
  // knows no such rate.
  SerialPort(const std::string& path, unsigned baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  // What has come, at most 512 bytes at a time; valid until the next call. Nothing once it is gone.
  std::span<const std::byte> read() noexcept;

 private:
  int file_ = -1;
  std::array<std::byte, 512> bytes_{};
};

}  // namespace farhand
