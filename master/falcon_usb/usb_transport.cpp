#include "master/falcon_usb/usb_transport.hpp"

#include <libusb.h>

#include <stdexcept>
#include <utility>

namespace farhand::falcon_usb {
namespace {

constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xcb48;
constexpr int kInterface = 0;
constexpr unsigned char kOut = 0x02, kIn = 0x81;
constexpr std::uint8_t kVendorRequest = 0x40;
constexpr unsigned kRequestMs = 1000, kNoTimeout = 0;
constexpr Duration kLookEvery = std::chrono::milliseconds(250);
constexpr std::size_t kReserved = 8;  // places in the queue for what is not a packet
constexpr int kMostCloseWaits = 20;

Refusal refusal(int error) noexcept {
  if (error == LIBUSB_ERROR_ACCESS) return Refusal::permission;
  return error == LIBUSB_ERROR_BUSY ? Refusal::busy : Refusal::other;
}

void handle_events(libusb_context* context, Duration most) noexcept {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(most).count();
  timeval timeout{.tv_sec = us / 1000000, .tv_usec = us % 1000000};
  libusb_handle_events_timeout_completed(context, &timeout, nullptr);
}

}  // namespace

void UsbTransport::FreeTransfer::operator()(libusb_transfer* t) const noexcept {
  libusb_free_transfer(t);
}

UsbTransport::UsbTransport(std::string serial) : serial_(std::move(serial)) {
  if (const int error = libusb_init(&context_); error != LIBUSB_SUCCESS)
    throw std::runtime_error(std::string("this machine gives no access to its USB: ") +
                             libusb_strerror(static_cast<libusb_error>(error)));
  request_.reset(libusb_alloc_transfer(0));
  for (TransferPtr& read : reads_) read.reset(libusb_alloc_transfer(0));
}

UsbTransport::~UsbTransport() {
  gone_ = true;
  for (int i = 0; i < kMostCloseWaits && handle_ != nullptr; ++i) {
    settle();
    if (handle_ != nullptr) handle_events(context_, std::chrono::milliseconds(10));
  }
  request_.reset();
  for (TransferPtr& read : reads_) read.reset();
  libusb_exit(context_);
}

void UsbTransport::wait(Duration most, TimePoint now) {
  if (handle_ == nullptr && now >= look_at_) look(now);
  if (size_ == 0) handle_events(context_, most);
  settle();
}

void UsbTransport::look(TimePoint now) {
  look_at_ = now + kLookEvery;
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context_, &list);
  libusb_device* found = nullptr;
  for (ssize_t i = 0; i < count && found == nullptr; ++i)
    if (matches(list[i])) found = list[i];
  if (found == nullptr)
    refused_ = Refusal::none;
  else
    open(found);
  if (list != nullptr) libusb_free_device_list(list, 1);
}

// Only an open device tells its serial number; one that cannot be opened is taken to match, so that
// the reason is said.
bool UsbTransport::matches(libusb_device* device) const noexcept {
  libusb_device_descriptor d{};
  if (libusb_get_device_descriptor(device, &d) != LIBUSB_SUCCESS) return false;
  if (d.idVendor != kVendor || d.idProduct != kProduct) return false;
  libusb_device_handle* handle = nullptr;
  if (serial_.empty() || libusb_open(device, &handle) != LIBUSB_SUCCESS) return true;
  std::array<unsigned char, 128> text{};
  const int length = libusb_get_string_descriptor_ascii(handle, d.iSerialNumber, text.data(),
                                                        static_cast<int>(text.size()));
  libusb_close(handle);
  return length > 0 && serial_ == std::string(text.begin(), text.begin() + length);
}

void UsbTransport::open(libusb_device* device) noexcept {
  const Refusal why = claim(device);
  if (why != Refusal::none) {
    if (why != refused_) push({.kind = EventKind::refused, .refusal = why});
    refused_ = why;
    return;
  }
  refused_ = Refusal::none;
  gone_ = false;
  push({.kind = EventKind::attached});
  for (std::size_t i = 0; i < kReads; ++i) {
    libusb_fill_bulk_transfer(reads_[i].get(), handle_, kIn, read_bytes_[i].data(),
                              static_cast<int>(kUsbPacketBytes), heard, this, kNoTimeout);
    if (!start(reads_[i].get())) gone_ = true;
  }
}

Refusal UsbTransport::claim(libusb_device* device) noexcept {
  if (const int error = libusb_open(device, &handle_); error != LIBUSB_SUCCESS) {
    handle_ = nullptr;
    return refusal(error);
  }
  libusb_set_auto_detach_kernel_driver(handle_, 1);
  const int error = libusb_claim_interface(handle_, kInterface);
  if (error == LIBUSB_SUCCESS) return Refusal::none;
  libusb_close(std::exchange(handle_, nullptr));
  return refusal(error);
}

bool UsbTransport::start(libusb_transfer* transfer) noexcept {
  const int error = libusb_submit_transfer(transfer);
  pending_ += error == LIBUSB_SUCCESS;
  return error == LIBUSB_SUCCESS;
}

void UsbTransport::submit(const Request& request, TimePoint) noexcept {
  if (handle_ == nullptr || gone_) return;
  unsigned char* bytes = request_bytes_.data();
  if (request.is_control) {
    libusb_fill_control_setup(bytes, kVendorRequest, request.control.request, request.control.value,
                              0, 0);
    libusb_fill_control_transfer(request_.get(), handle_, bytes, done, this, kRequestMs);
  } else {
    std::transform(request.data.view().begin(), request.data.view().end(), bytes,
                   [](std::byte b) { return std::to_integer<unsigned char>(b); });
    libusb_fill_bulk_transfer(request_.get(), handle_, kOut, bytes,
                              static_cast<int>(request.data.size), done, this, kRequestMs);
  }
  const int error = libusb_submit_transfer(request_.get());
  pending_ += error == LIBUSB_SUCCESS;
  if (error == LIBUSB_ERROR_NO_DEVICE)
    gone_ = true;
  else if (error != LIBUSB_SUCCESS)
    push({.kind = EventKind::failed});
}

void UsbTransport::done(libusb_transfer* t) {
  auto& self = *static_cast<UsbTransport*>(t->user_data);
  --self.pending_;
  if (t->status == LIBUSB_TRANSFER_NO_DEVICE) self.gone_ = true;
  if (self.gone_) return;
  const bool control = t->type == LIBUSB_TRANSFER_TYPE_CONTROL;
  const bool all = control || t->actual_length == t->length;
  const bool sent = t->status == LIBUSB_TRANSFER_COMPLETED && all;
  self.push({.kind = sent ? EventKind::sent : EventKind::failed});
}

void UsbTransport::heard(libusb_transfer* t) {
  auto& self = *static_cast<UsbTransport*>(t->user_data);
  --self.pending_;
  if (t->status == LIBUSB_TRANSFER_NO_DEVICE) self.gone_ = true;
  if (self.gone_) return;
  if (t->status == LIBUSB_TRANSFER_COMPLETED && t->actual_length > 0) {
    Event event{.kind = EventKind::received};
    event.packet.size = static_cast<std::size_t>(t->actual_length);
    std::transform(t->buffer, t->buffer + t->actual_length, event.packet.bytes.begin(),
                   [](unsigned char b) { return std::byte{b}; });
    self.push(event);
  }
  if (!self.start(t)) self.gone_ = true;
}

void UsbTransport::push(const Event& event) noexcept {
  const bool packet = event.kind == EventKind::received;
  if (size_ + (packet ? kReserved : 0) >= events_.size()) {
    ++dropped_;
    return;
  }
  events_[(first_ + size_++) % events_.size()] = event;
}

const Event* UsbTransport::next_event(TimePoint) noexcept {
  if (size_ == 0) handle_events(context_, Duration::zero());
  settle();
  if (size_ == 0) return nullptr;
  event_ = events_[first_];
  first_ = (first_ + 1) % events_.size();
  --size_;
  return &event_;
}

// A device that is gone is closed once no transfer of it is pending.
void UsbTransport::settle() noexcept {
  if (!gone_ || handle_ == nullptr) return;
  if (pending_ == 0) return close();
  libusb_cancel_transfer(request_.get());
  for (const TransferPtr& read : reads_) libusb_cancel_transfer(read.get());
}

void UsbTransport::close() noexcept {
  libusb_release_interface(handle_, kInterface);
  libusb_close(std::exchange(handle_, nullptr));
  request_->dev_handle = nullptr;  // what is not in flight may be cancelled, too
  for (const TransferPtr& read : reads_) read->dev_handle = nullptr;
  gone_ = false;
  push({.kind = EventKind::detached});
}

}  // namespace farhand::falcon_usb
