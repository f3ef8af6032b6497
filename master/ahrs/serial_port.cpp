#include "master/ahrs/serial_port.hpp"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/line_rates.hpp"
#include "master/ahrs/line_fault.hpp"

namespace farhand {
namespace {

constexpr speed_t speed(std::uint64_t baud) noexcept {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    case 460800:
      return B460800;
    case 921600:
      return B921600;
    default:
      return B0;
  }
}

static_assert(std::all_of(kLineRates.begin(), kLineRates.end(),
                          [](std::uint64_t baud) { return speed(baud) != B0; }));

// Bytes as they are, no flow control, no echo, no signals.
bool set_raw(int file, speed_t rate) noexcept {
  termios line{};
  if (tcgetattr(file, &line) != 0) return false;
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  line.c_cc[VMIN] = 0;
  line.c_cc[VTIME] = 0;
  return cfsetispeed(&line, rate) == 0 && cfsetospeed(&line, rate) == 0 &&
         tcsetattr(file, TCSANOW, &line) == 0 && tcflush(file, TCIFLUSH) == 0;
}

}  // namespace

SerialPort::SerialPort(const std::string& path, unsigned baud) {
  const speed_t rate = speed(baud);
  if (rate == B0)
    throw std::runtime_error("serial: no line runs at " + std::to_string(baud) + " baud; give " +
                             kLineRatesListed);
  file_ = open(path.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) throw std::runtime_error("serial: " + path + " " + unreadable_line(path, errno));
  if (set_raw(file_, rate)) return;
  const std::string why = std::strerror(errno);
  close(file_);
  throw std::runtime_error("serial: " + path + " is no serial line (" + why +
                           "); give one such as /dev/ttyUSB0");
}

SerialPort::~SerialPort() {
  close(file_);
}

std::span<const std::byte> SerialPort::read() noexcept {
  const ssize_t got = ::read(file_, bytes_.data(), bytes_.size());
  return std::span(bytes_).first(got > 0 ? static_cast<std::size_t>(got) : 0);
}

}  // namespace farhand
