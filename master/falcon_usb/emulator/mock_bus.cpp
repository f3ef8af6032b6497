#include "master/falcon_usb/emulator/mock_bus.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "common/realtime.hpp"
#include "master/falcon_usb/ftdi.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr unsigned kNumber = 2;  // of the emulated one on the bus
constexpr unsigned char kIn = 0x81;
constexpr unsigned char kVendorRequest = 0x40;
constexpr std::size_t kSetupBytes = 8;

std::string text(const char* format, unsigned number) {
  char out[64];
  std::snprintf(out, sizeof out, format, number);
  return out;
}
std::string node_of(unsigned number) {
  return text("/dev/bus/usb/001/%03u", number);
}
std::string sysfs_of(unsigned number) {
  return text("/sys/devices/usb%u", number);
}

// The calling thread becomes as prompt as a kernel, if this user may have it so.
void be_prompt() noexcept {
  constexpr int kPriority = 85;  // above those who ask, the device's thread and the loop
  thread_local bool is = false;
  if (!std::exchange(is, true)) schedule_fifo(kPriority);
}

}  // namespace

MockBus::MockBus(MockBusConfig config)
    : config_(std::move(config)),
      emulator_(config_.emulator, config_.mechanism),
      testbed_(umockdev_testbed_new()),
      handler_(umockdev_ioctl_base_new()) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(handle), this);
  if (config_.real_time) time_ = std::thread([this] { live(); });
}

MockBus::~MockBus() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_one();
  if (time_.joinable()) time_.join();
  for (const Urb& urb : flying_) umockdev_ioctl_data_unref(urb.data);
  g_object_unref(handler_);
  g_object_unref(testbed_);
}

// ---- the user's doings

void MockBus::plug() {
  {
    const std::lock_guard lock(mutex_);
    if (config_.real_time) make_file();
    const TimePoint now = config_.clock();
    emulator_.plug(now);
    emulator_.next_event(now + std::chrono::seconds(1));  // the kernel says itself that it is there
    there_ = true;
  }
  wake_.notify_one();
  add_device(kNumber);
}

void MockBus::unplug() {
  {
    const std::lock_guard lock(mutex_);
    const TimePoint now = config_.clock();
    emulator_.unplug(now);
    emulator_.next_event(now);
    there_ = false;
    packets_.clear();
    if (doorbell_) doorbell_->ring();
  }
  umockdev_testbed_detach_ioctl(testbed_, node_of(kNumber).c_str(), nullptr);
  umockdev_testbed_uevent(testbed_, sysfs_of(kNumber).c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, sysfs_of(kNumber).c_str());
  const std::lock_guard lock(mutex_);
  doorbell_.reset();
}

void MockBus::plug_taken(unsigned number) {
  add_device(number);
}

void MockBus::add_device(unsigned number) {
  const bool made = number == kNumber && config_.real_time;  // its file
  const std::string device =
      text("P: /devices/usb%u\n", number) + (made ? "" : text("N: bus/usb/001/%03u\n", number)) +
      "E: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\n" + text("E: DEVNUM=%03u\n", number) +
      text("E: DEVNAME=/dev/bus/usb/001/%03u\n", number) +
      "E: DEVTYPE=usb_device\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\n" +
      text("A: devnum=%u\\n\n", number) +
      "A: speed=12\\n\n"
      "H: descriptors=1201000200000008030448CB0006010203010902200001010080"
      "2D0904000002FFFFFF020705810240000007050202400000\n";
  umockdev_testbed_attach_ioctl(testbed_, node_of(number).c_str(), handler_, nullptr);
  umockdev_testbed_add_from_string(testbed_, device.c_str(), nullptr);
}

void MockBus::occupy(bool busy) {
  const std::lock_guard lock(mutex_);
  busy_ = busy;
}

void MockBus::bind_driver() {
  const std::lock_guard lock(mutex_);
  bound_ = true;
}

// Others can still look, and listen for plugs; and the mock wants to be connected with even for
// what cannot be opened.
void MockBus::forbid() {
  const std::string root = this->root();
  chmod((root + node_of(kNumber)).c_str(), 0);
  chmod((root + "/ioctl" + node_of(kNumber)).c_str(), 0777);
  chmod(root.c_str(), 0777);
}

void MockBus::make_file() {
  const std::string file = root() + node_of(kNumber);
  std::filesystem::create_directories(std::filesystem::path(file).parent_path());
  doorbell_.emplace(file);
}

std::string MockBus::root() const {
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  std::string out = root;
  g_free(root);
  return out;
}

void MockBus::set_faults(const SerialFaults& serial, const BusFaults& bus) {
  const std::lock_guard lock(mutex_);
  emulator_.set_faults(serial, bus);
}

void MockBus::cut_power() {
  const std::lock_guard lock(mutex_);
  emulator_.cut_power();
}

void MockBus::fail_reads(int count, int error) {
  const std::lock_guard lock(mutex_);
  reads_to_fail_ = count;
  read_error_ = error;
}

void MockBus::stick() {
  const std::lock_guard lock(mutex_);
  stuck_ = true;
}

int MockBus::halts_cleared() const {
  const std::lock_guard lock(mutex_);
  return halts_cleared_;
}

// ---- what the kernel is asked

bool MockBus::Urb::reads() const {
  return urb().type == USBDEVFS_URB_TYPE_BULK && urb().endpoint == kIn;
}

void MockBus::Urb::finish(int with, int length) {
  finished = true;
  status = with;
  urb().actual_length = length;
}

gboolean MockBus::handle(UMockdevIoctlBase*, UMockdevIoctlClient* client, MockBus* self) {
  int error = 0;
  if (self->config_.real_time) be_prompt();
  {
    const std::lock_guard lock(self->mutex_);
    error = self->answer(client);
  }
  self->wake_.notify_one();
  umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  return TRUE;
}

// 0 or an error number.
int MockBus::answer(UMockdevIoctlClient* client) {
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* d = umockdev_ioctl_data_resolve(argument, 0, sizeof(guint32), nullptr);
      if (d == nullptr) return ENODEV;
      const guint32 capabilities = USBDEVFS_CAP_BULK_CONTINUATION |
                                   USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                   USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      std::memcpy(d->data, &capabilities, sizeof capabilities);
      umockdev_ioctl_data_unref(d);
      return 0;
    }
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      return claim(client);
    case USBDEVFS_GETDRIVER:
      return driver(argument);
    case USBDEVFS_SUBMITURB:
      return submit(argument);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(argument);
    case USBDEVFS_DISCARDURB:
      return discard(*reinterpret_cast<gulong*>(argument->data));
    case USBDEVFS_CLEAR_HALT:
      ++halts_cleared_;
      return 0;
    default:
      return 0;
  }
}

// Who has it now leaves nothing behind of who had it before, and may have been killed.
int MockBus::claim(UMockdevIoctlClient* client) {
  if (busy_ || umockdev_ioctl_client_get_devnode(client) != node_of(kNumber)) return EBUSY;
  for (const Urb& urb : flying_) umockdev_ioctl_data_unref(urb.data);
  flying_.clear();
  reaping_ = false;
  return 0;
}

int MockBus::driver(UMockdevIoctlData* argument) const {
  if (!bound_) return ENODATA;
  UMockdevIoctlData* d =
      umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_getdriver), nullptr);
  if (d == nullptr) return ENODEV;
  std::strcpy(reinterpret_cast<usbdevfs_getdriver*>(d->data)->driver, "ftdi_sio");
  umockdev_ioctl_data_unref(d);
  return 0;
}

int MockBus::submit(UMockdevIoctlData* argument) {
  if (!there_) return ENODEV;
  UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
  if (data == nullptr) return ENODEV;  // who asked is gone
  Urb urb{data};
  UMockdevIoctlData* buffer = umockdev_ioctl_data_resolve(
      data, offsetof(usbdevfs_urb, buffer), static_cast<gsize>(urb.urb().buffer_length), nullptr);
  if (buffer == nullptr) {
    umockdev_ioctl_data_unref(data);
    return ENODEV;
  }
  umockdev_ioctl_data_unref(buffer);
  const unsigned char* bytes = urb.bytes();
  const auto length = static_cast<std::size_t>(urb.urb().buffer_length);
  if (urb.urb().type == USBDEVFS_URB_TYPE_BULK && !urb.reads())
    emulator_.submit(request_of(std::as_bytes(std::span(bytes, length))), config_.clock());
  else if (urb.urb().type == USBDEVFS_URB_TYPE_CONTROL && bytes[0] == kVendorRequest)
    emulator_.submit(
        request_of(Control{bytes[1], static_cast<std::uint16_t>(bytes[2] | bytes[3] << 8)}),
        config_.clock());
  else if (!urb.reads())
    describe(urb);
  flying_.push_back(urb);
  return 0;
}

// String descriptors: the language, and the serial number under any other index.
void MockBus::describe(Urb& urb) const {
  std::vector<unsigned char> text{0, 3};
  if (urb.bytes()[2] == 0)
    text.insert(text.end(), {0x09, 0x04});
  else
    for (const char c : config_.serial) text.insert(text.end(), {static_cast<unsigned char>(c), 0});
  text[0] = static_cast<unsigned char>(text.size());
  std::memcpy(urb.bytes() + kSetupBytes, text.data(), text.size());
  urb.finish(0, static_cast<int>(text.size()));
}

// What is finished now, one by one, and then nothing: libusb asks until there is nothing more, and
// a slow one would never hear that from a chip that has a packet every millisecond.
int MockBus::reap(UMockdevIoctlData* argument) {
  if (!std::exchange(reaping_, true)) let_time_pass();
  for (auto urb = flying_.begin(); urb != flying_.end(); ++urb) {
    if (!there_) urb->finish(-ENODEV, 0);
    if (!urb->finished) continue;
    urb->urb().status = urb->status;
    UMockdevIoctlData* p = umockdev_ioctl_data_resolve(argument, 0, sizeof(gpointer), nullptr);
    if (p == nullptr) return ENODEV;
    umockdev_ioctl_data_set_ptr(p, 0, urb->data);
    umockdev_ioctl_data_unref(p);
    umockdev_ioctl_data_unref(urb->data);
    flying_.erase(urb);
    return 0;
  }
  reaping_ = false;
  if (!there_) return ENODEV;
  if (doorbell_) doorbell_->quiet();
  return EAGAIN;
}

int MockBus::discard(gulong address) {
  for (Urb& urb : flying_)
    if (urb.data->client_addr == address && !urb.finished) {
      if (!stuck_) urb.finish(-ENOENT, 0);
      return 0;
    }
  return EINVAL;
}

// ---- the emulator's side

void MockBus::live() {
  be_prompt();
  std::unique_lock lock(mutex_);
  while (!ends_) {
    TimePoint until = TimePoint::max();
    if (!reaping_) {
      let_time_pass();
      const TimePoint tell = tell_at();
      const bool tells = tell <= config_.clock();
      if (tells && doorbell_) doorbell_->ring();
      until = tells ? emulator_.due() : std::min(tell, emulator_.due());
    }
    wake_.wait_until(lock, until);
  }
}

// When the host is to hear of what is finished.
TimePoint MockBus::tell_at() const {
  TimePoint at = TimePoint::max();
  for (const Urb& urb : flying_)
    if (urb.finished) at = std::min(at, urb.tell_at);
  return at;
}

void MockBus::let_time_pass() {
  const TimePoint now = config_.clock();
  while (const Event* event = emulator_.next_event(now)) hear(*event, now);
  fill_reads();
}

void MockBus::hear(const Event& event, TimePoint now) {
  // The chip does not queue packets that carry nothing. In real time they are left out altogether:
  // to wake the host a thousand times a second for nothing costs too much here.
  const bool useless = config_.real_time || !packets_.empty();
  const bool empty = event.packet.size <= kFtdiStatusBytes && useless;
  if (event.kind == EventKind::received && !empty) packets_.push_back(event.packet);
  if (event.kind != EventKind::sent && event.kind != EventKind::failed) return;
  const bool sent = event.kind == EventKind::sent;
  for (Urb& urb : flying_) {
    if (urb.reads() || urb.finished) continue;
    const bool bulk = urb.urb().type == USBDEVFS_URB_TYPE_BULK;
    urb.finish(sent ? 0 : -EPROTO, sent && bulk ? urb.urb().buffer_length : 0);
    // Told together with the answer to it, it costs half as much.
    if (sent && bulk) urb.tell_at = now + std::chrono::milliseconds(1);
  }
}

void MockBus::fill_reads() {
  for (Urb& urb : flying_) {
    if (!urb.reads() || urb.finished) continue;
    if (reads_to_fail_ > 0) {
      --reads_to_fail_;
      urb.finish(read_error_, 0);
    } else if (!packets_.empty()) {
      const UsbBytes& packet = packets_.front();
      std::memcpy(urb.bytes(), packet.bytes.data(), packet.size);
      urb.finish(0, static_cast<int>(packet.size));
      packets_.pop_front();
    }
  }
}

}  // namespace farhand::falcon_usb
