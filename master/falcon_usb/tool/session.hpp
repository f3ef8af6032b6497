// A Falcon in the hands of farhand-falcon: driver and transport on this one thread, and the user at
// the terminal.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "master/falcon_usb/driver.hpp"
#include "master/falcon_usb/usb_transport.hpp"

namespace farhand::falcon_usb {

struct SessionConfig {
  DriverConfig driver;
  std::string serial;
  std::vector<std::byte> firmware;
};

inline constexpr Duration kHands = std::chrono::minutes(3);  // for what the user must do

class Session {
 public:
  explicit Session(SessionConfig config);
  ~Session();  // zero torque, then closes
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Keeps the device asked until `done`, called after every turn, says so; for at most `most`.
  // False if time was up first. Throws a sentence if the driver has failed, and if the user pressed
  // Ctrl-C. Says on stderr what the user is to do, each time that changes.
  bool run(Duration most, const std::function<bool(TimePoint)>& done);

  // The same, called once for each new sample that can be believed, at most so many times: a drive
  // has them all on a slow machine, too, where there are fewer in a second. Ends when the device is
  // not homed any more.
  void run_samples(int most, const std::function<bool(TimePoint, const Sample&)>& done);

  // Until the driver is in that phase; throws a sentence if it is not within `most`.
  void reach(Phase phase, Duration most);

  // Shows `question`, waits for a line from the terminal and keeps the device asked meanwhile.
  std::string ask(const std::string& question);

  Driver& driver() noexcept { return driver_; }
  bool armed() const noexcept { return driver_.status().phase == Phase::armed; }

 private:
  void turn(TimePoint now);
  void advise();

  std::vector<std::byte> firmware_;
  UsbTransport transport_;
  Driver driver_;
  std::optional<DriverStatus> told_;
};

}  // namespace farhand::falcon_usb
