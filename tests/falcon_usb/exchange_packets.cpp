// What the emulator's test runs: waits for a Falcon to be homed, and exchanges 200 packets more.
// Exit status 0, or 1 with what the driver says.
#include <cstdio>

#include "master/falcon_usb/driver.hpp"
#include "master/falcon_usb/usb_transport.hpp"

int main() {
  using namespace farhand;
  using namespace farhand::falcon_usb;
  // Time is the number of looks, each of which the emulator answers: so nothing depends on how fast
  // the machine is.
  constexpr auto kLook = std::chrono::microseconds(100);
  constexpr TimePoint kBegin{std::chrono::hours(1)}, kEnd = kBegin + std::chrono::minutes(2);
  UsbTransport transport;
  Driver driver({.pacing = Pacing::device});
  std::uint64_t last = 0;  // to be accepted, once homed
  for (TimePoint now = kBegin; now < kEnd; now += kLook) {
    transport.wait(kLook, now);
    driver.write(now, Vec6::Zero());
    pump(transport, driver, now);
    const DriverStatus status = driver.status();
    if (last == 0 && status.phase == Phase::homed) last = status.exchange.accepted + 200;
    if (last != 0 && status.exchange.accepted >= last) return 0;
  }
  std::fprintf(stderr, "%s: %s\n", to_string(driver.status().phase),
               to_string(driver.status().trouble));
  return 1;
}
