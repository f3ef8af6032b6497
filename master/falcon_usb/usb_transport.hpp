// The transport over libusb: a Falcon found by vendor, product and, if given, serial number, and
// found again whenever it is plugged in. Of several the first that can be had. Asynchronous
// transfers, with reads always pending; errors of reading are mended a few times, then the device
// counts as gone and is looked for anew. A request's time is up in `now`, not by libusb's clock.
//
// Everything happens on the thread that calls wait(), submit() and next_event(). Only wait() may
// block: it also looks for the device and mends, which submit() and next_event() never do. libusb
// itself allocates whenever a transfer is submitted. That thread is therefore not the control
// loop's.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "master/falcon_usb/transport.hpp"

struct libusb_context;
struct libusb_device;
struct libusb_device_handle;
struct libusb_transfer;

namespace farhand::falcon_usb {

class UsbTransport {
 public:
  // Any Falcon if no serial number is given. Throws std::runtime_error if there is no USB at all.
  explicit UsbTransport(std::string serial = {});
  ~UsbTransport();
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;

  // Until something happens or `most` has passed; next_event() tells what did. Events come in here
  // alone, so that a bus faster than its listener does not hold him. Without a device looks for
  // one, at most four times a second.
  void wait(Duration most, TimePoint now);
  void submit(const Request& request, TimePoint now) noexcept;
  const Event* next_event(TimePoint now) noexcept;

  std::uint64_t dropped() const noexcept { return dropped_; }  // packets nobody fetched in time

 private:
  struct FreeTransfer {
    void operator()(libusb_transfer* t) const noexcept;
  };
  using TransferPtr = std::unique_ptr<libusb_transfer, FreeTransfer>;
  static constexpr std::size_t kReads = 2, kSetupBytes = 8;

  static void done(libusb_transfer* transfer);
  static void heard(libusb_transfer* transfer);
  void look(TimePoint now);
  bool has_serial() const;
  Refusal open(libusb_device* device);
  void refuse(Refusal why) noexcept;
  void attach() noexcept;
  void mend() noexcept;
  bool start_read(libusb_transfer* read) noexcept;
  bool start_reads() noexcept;
  void cancel_reads() noexcept;
  void settle(TimePoint now) noexcept;
  void close() noexcept;
  void push(const Event& event) noexcept;

  std::string serial_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  TransferPtr request_;
  std::array<TransferPtr, kReads> reads_;
  std::array<unsigned char, kSetupBytes + kUsbPacketBytes> request_bytes_{};
  std::array<std::array<unsigned char, kUsbPacketBytes>, kReads> read_bytes_{};
  bool request_pending_ = false;
  TimePoint request_until_{};
  int pending_reads_ = 0;
  bool gone_ = false;
  bool reads_failed_ = false, write_halted_ = false;
  int mended_ = 0;  // since the last packet
  TimePoint look_at_ = TimePoint::min();
  Refusal refused_ = Refusal::none;  // said already
  std::array<Event, 64> events_{};
  std::size_t first_ = 0, size_ = 0;
  Event event_;
  std::uint64_t dropped_ = 0;
};

static_assert(Transport<UsbTransport>);

}  // namespace farhand::falcon_usb
