// The emulated Falcon as a device file of a mocked machine: what libusb asks of the kernel goes to
// the emulator. This process needs umockdev's preload library before all others; those it starts
// see the same machine.
//
// The device is plugged and unplugged here, not at the emulator. Requests are answered on a thread
// of the mock's own, which is also where the clock and the mechanism are asked; in real time on
// another one, too, but never on both at once.
#pragma once

#include <linux/ioctl.h>
#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "master/falcon_usb/emulator/doorbell.hpp"
#include "master/falcon_usb/emulator/emulator.hpp"

namespace farhand::falcon_usb {

struct MockBusConfig {
  EmulatorConfig emulator;
  Mechanism mechanism;
  std::function<TimePoint()> clock;
  std::string serial;
  // The clock runs by itself: what is finished is told when it is due, and until then libusb
  // sleeps. Else time passes when libusb asks, and its file always looks as if something were
  // finished.
  bool real_time = false;
};

class MockBus {
 public:
  explicit MockBus(MockBusConfig config);
  ~MockBus();
  MockBus(const MockBus&) = delete;
  MockBus& operator=(const MockBus&) = delete;

  void plug();
  void unplug();
  // Another Falcon, which is always in other hands; its number, not 2, decides its place.
  void plug_taken(unsigned number);
  // In other hands, for those who try to have it from now on.
  void occupy(bool busy);
  // A driver of the kernel's has it from now on.
  void bind_driver();
  // To all but root.
  void forbid();
  void set_faults(const SerialFaults& serial, const BusFaults& bus);
  void cut_power();
  // So many reads from now on end with a negative error number.
  void fail_reads(int count, int error);
  // Transfers that are cancelled do not end any more.
  void stick();
  int halts_cleared() const;

 private:
  // A transfer of the host's, with the kernel's own description of it in `data`.
  struct Urb {
    UMockdevIoctlData* data;
    bool finished = false;
    int status = 0;
    TimePoint tell_at = TimePoint::min();  // if finished, in real time
    usbdevfs_urb& urb() const { return *reinterpret_cast<usbdevfs_urb*>(data->data); }
    unsigned char* bytes() const { return static_cast<unsigned char*>(urb().buffer); }
    bool reads() const;
    void finish(int with, int length);
  };

  static gboolean handle(UMockdevIoctlBase*, UMockdevIoctlClient* client, MockBus* self);
  int answer(UMockdevIoctlClient* client);
  int claim(UMockdevIoctlClient* client);
  int driver(UMockdevIoctlData* argument) const;
  int submit(UMockdevIoctlData* argument);
  void describe(Urb& urb) const;
  int reap(UMockdevIoctlData* argument);
  int discard(gulong address);
  void let_time_pass();
  void hear(const Event& event, TimePoint now);
  void fill_reads();
  void add_device(unsigned number);
  void make_file();
  void live();
  TimePoint tell_at() const;
  std::string root() const;  // directory of the mocked machine

  mutable std::mutex mutex_;
  MockBusConfig config_;
  Emulator emulator_;
  bool there_ = false, busy_ = false, bound_ = false, stuck_ = false;
  bool reaping_ = false;  // what was finished when time passed last
  int reads_to_fail_ = 0, read_error_ = 0, halts_cleared_ = 0;
  std::deque<Urb> flying_;
  std::deque<UsbBytes> packets_;
  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_;
  std::optional<Doorbell> doorbell_;  // of the device that is there, in real time
  std::condition_variable wake_;
  bool ends_ = false;
  std::thread time_;  // lets it pass
};

}  // namespace farhand::falcon_usb
