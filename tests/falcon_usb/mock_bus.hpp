// The emulated Falcon as a device file: what libusb asks of the kernel goes to the emulator. Time
// is a counter that the test moves, so that nothing depends on how fast the machine is.
#pragma once

#include <linux/ioctl.h>
#include <linux/usbdevice_fs.h>
#include <sys/stat.h>
#include <umockdev.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "tests/falcon_usb/emulated_falcon.hpp"

namespace farhand::falcon_usb {

class MockBus {
 public:
  static constexpr const char* kSerial = "FH0042";

  explicit MockBus(const EmulatorConfig& config)
      : emulator_(config, grip.mechanism()),
        testbed_(umockdev_testbed_new()),
        handler_(umockdev_ioctl_base_new()) {
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(handle), this);
  }
  ~MockBus() {
    for (const Urb& urb : flying_) umockdev_ioctl_data_unref(urb.data);
    g_object_unref(handler_);
    g_object_unref(testbed_);
  }
  MockBus(const MockBus&) = delete;
  MockBus& operator=(const MockBus&) = delete;

  void plug() {
    {
      const std::lock_guard lock(mutex_);
      emulator_.plug(now_);
      emulator_.next_event(now_ + 1s);  // the kernel says itself that it is there
      there_ = true;
    }
    umockdev_testbed_attach_ioctl(testbed_, kNode, handler_, nullptr);
    umockdev_testbed_add_from_string(testbed_, kDevice, nullptr);
  }
  void unplug() {
    {
      const std::lock_guard lock(mutex_);
      emulator_.unplug(now_);
      emulator_.next_event(now_);
      there_ = false;
      packets_.clear();
    }
    umockdev_testbed_detach_ioctl(testbed_, kNode, nullptr);
    umockdev_testbed_uevent(testbed_, kSysfs, "remove");
    umockdev_testbed_remove_device(testbed_, kSysfs);
  }
  void occupy(bool busy) {
    const std::lock_guard lock(mutex_);
    busy_ = busy;
  }
  // To all but root.
  void forbid() {
    gchar* root = umockdev_testbed_get_root_dir(testbed_);
    chmod((std::string(root) + kNode).c_str(), 0);
    g_free(root);
  }
  TimePoint advance(Duration by) {
    const std::lock_guard lock(mutex_);
    return now_ += by;
  }

  ScriptedGrip grip;

 private:
  static constexpr const char* kNode = "/dev/bus/usb/001/002";
  static constexpr const char* kSysfs = "/sys/devices/usb1";
  static constexpr const char* kDevice =
      "P: /devices/usb1\nN: bus/usb/001/002\nE: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\n"
      "E: DEVNUM=002\nE: DEVNAME=/dev/bus/usb/001/002\nE: DEVTYPE=usb_device\n"
      "A: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=2\\n\nA: speed=12\\n\n"
      "H: descriptors=1201000200000008030448CB0006010203010902200001010080"
      "2D0904000002FFFFFF020705810240000007050202400000\n";

  // A transfer of the host's, with the kernel's own description of it in `data`.
  struct Urb {
    UMockdevIoctlData* data;
    bool finished = false;
    int status = 0;
    usbdevfs_urb& urb() const { return *reinterpret_cast<usbdevfs_urb*>(data->data); }
    unsigned char* bytes() const { return static_cast<unsigned char*>(urb().buffer); }
    bool reads() const { return urb().type == USBDEVFS_URB_TYPE_BULK && urb().endpoint == 0x81; }
  };

  static gboolean handle(UMockdevIoctlBase*, UMockdevIoctlClient* client, MockBus* self) {
    const std::lock_guard lock(self->mutex_);
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    const auto complete = [&](int error) {
      umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
      return TRUE;
    };
    switch (umockdev_ioctl_client_get_request(client)) {
      case USBDEVFS_GET_CAPABILITIES: {
        UMockdevIoctlData* d = umockdev_ioctl_data_resolve(argument, 0, sizeof(guint32), nullptr);
        const guint32 capabilities = USBDEVFS_CAP_BULK_CONTINUATION |
                                     USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                     USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
        std::memcpy(d->data, &capabilities, sizeof capabilities);
        umockdev_ioctl_data_unref(d);
        return complete(0);
      }
      case USBDEVFS_CLAIMINTERFACE:
      case USBDEVFS_DISCONNECT_CLAIM:
        return complete(self->busy_ ? EBUSY : 0);
      case USBDEVFS_SUBMITURB:
        return complete(self->submit(argument));
      case USBDEVFS_REAPURB:
      case USBDEVFS_REAPURBNDELAY:
        return complete(self->reap(argument));
      case USBDEVFS_DISCARDURB:
        return complete(self->discard(*reinterpret_cast<gulong*>(argument->data)));
      default:
        return complete(0);
    }
  }

  int submit(UMockdevIoctlData* argument) {
    if (!there_) return ENODEV;
    UMockdevIoctlData* data =
        umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
    Urb urb{data};
    umockdev_ioctl_data_unref(
        umockdev_ioctl_data_resolve(data, offsetof(usbdevfs_urb, buffer),
                                    static_cast<gsize>(urb.urb().buffer_length), nullptr));
    const unsigned char* bytes = urb.bytes();
    const auto length = static_cast<std::size_t>(urb.urb().buffer_length);
    if (urb.urb().type == USBDEVFS_URB_TYPE_BULK && !urb.reads())
      emulator_.submit(request_of(std::as_bytes(std::span(bytes, length))), now_);
    else if (urb.urb().type == USBDEVFS_URB_TYPE_CONTROL && bytes[0] == 0x40)
      emulator_.submit(
          request_of(Control{bytes[1], static_cast<std::uint16_t>(bytes[2] | bytes[3] << 8)}),
          now_);
    else if (!urb.reads())
      describe(urb);
    flying_.push_back(urb);
    return 0;
  }

  // String descriptors: the language, and the serial number under any other index.
  static void describe(Urb& urb) {
    std::vector<unsigned char> text{0, 3};
    if (urb.bytes()[2] == 0) text.insert(text.end(), {0x09, 0x04});
    for (const char* c = kSerial; urb.bytes()[2] != 0 && *c != 0; ++c)
      text.insert(text.end(), {static_cast<unsigned char>(*c), 0});
    text[0] = static_cast<unsigned char>(text.size());
    std::memcpy(urb.bytes() + 8, text.data(), text.size());
    urb.urb().actual_length = static_cast<int>(text.size());
    urb.finished = true;
  }

  int reap(UMockdevIoctlData* argument) {
    let_time_pass();
    for (auto urb = flying_.begin(); urb != flying_.end(); ++urb) {
      if (!there_) urb->finished = true, urb->status = -ENODEV;
      if (!urb->finished) continue;
      urb->urb().status = urb->status;
      UMockdevIoctlData* p = umockdev_ioctl_data_resolve(argument, 0, sizeof(gpointer), nullptr);
      umockdev_ioctl_data_set_ptr(p, 0, urb->data);
      umockdev_ioctl_data_unref(p);
      umockdev_ioctl_data_unref(urb->data);
      flying_.erase(urb);
      return 0;
    }
    return there_ ? EAGAIN : ENODEV;
  }

  void let_time_pass() {
    while (const Event* event = emulator_.next_event(now_)) {
      if (event->kind == EventKind::received) packets_.push_back(event->packet);
      if (event->kind != EventKind::sent) continue;
      for (Urb& urb : flying_) {
        if (urb.reads() || urb.finished) continue;
        const bool bulk = urb.urb().type == USBDEVFS_URB_TYPE_BULK;
        urb.urb().actual_length = bulk ? urb.urb().buffer_length : 0;
        urb.finished = true;
      }
    }
    for (Urb& urb : flying_) {
      if (!urb.reads() || urb.finished || packets_.empty()) continue;
      std::memcpy(urb.bytes(), packets_.front().bytes.data(), packets_.front().size);
      urb.urb().actual_length = static_cast<int>(packets_.front().size);
      urb.finished = true;
      packets_.pop_front();
    }
  }

  int discard(gulong address) {
    for (Urb& urb : flying_)
      if (urb.data->client_addr == address && !urb.finished) {
        urb.finished = true;
        urb.status = -ENOENT;
        return 0;
      }
    return EINVAL;
  }

  std::mutex mutex_;  // libusb's ioctls are answered on a thread of the test bed's
  TimePoint now_ = kStart;
  Emulator emulator_;
  bool there_ = false, busy_ = false;
  std::deque<Urb> flying_;
  std::deque<UsbBytes> packets_;
  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_;
};

}  // namespace farhand::falcon_usb
