// An AHRS on a serial line, for the loop.
#pragma once

#include "master/ahrs/frames.hpp"
#include "master/ahrs/serial_port.hpp"

namespace farhand {

class AhrsLine {
 public:
  // Throws as SerialPort.
  AhrsLine(const std::string& path, unsigned baud, AhrsFormat format)
      : port_(path, baud), parser_(format) {}

  // The oldest sample that has come and was not given yet. Never blocks.
  std::optional<AhrsSample> next() noexcept {
    return next_sample(parser_, [this] { return port_.read(); });
  }

 private:
  SerialPort port_;
  AhrsParser parser_;
};

}  // namespace farhand
