#include "master/falcon_usb/usb_transport.hpp"

#include <utility>

#include "master/falcon_usb/usb_identity.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr unsigned char kOut = 0x02, kIn = 0x81;
constexpr std::uint8_t kVendorRequest = 0x40;
constexpr unsigned kNoTimeout = 0;
constexpr Duration kLookEvery = std::chrono::milliseconds(250);
constexpr std::size_t kReserved = 8;  // places in the queue for what is not a packet
constexpr int kMostCloseWaits = 20;
constexpr int kMostMended = 8;

void handle_events(libusb_context* context, Duration most) noexcept {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(most).count();
  timeval timeout{.tv_sec = us / 1000000, .tv_usec = us % 1000000};
  libusb_handle_events_timeout_completed(context, &timeout, nullptr);
}

}  // namespace

void UsbTransport::FreeTransfer::operator()(libusb_transfer* t) const noexcept {
  libusb_free_transfer(t);
}

UsbTransport::UsbTransport(std::string serial) : serial_(std::move(serial)), context_(open_usb()) {
  request_.reset(libusb_alloc_transfer(0));
  for (TransferPtr& read : reads_) read.reset(libusb_alloc_transfer(0));
}

UsbTransport::~UsbTransport() {
  gone_ = true;
  for (int i = 0; i < kMostCloseWaits && handle_ != nullptr; ++i) {
    settle(request_until_);
    if (handle_ != nullptr) handle_events(context_, std::chrono::milliseconds(10));
  }
  if (handle_ != nullptr) {
    // The kernel does not give the transfers back, and libusb still has them in its lists: leaked,
    // with its context, rather than freed under its hands.
    if (request_pending_) request_.release();
    for (TransferPtr& read : reads_) read.release();
    return;
  }
  request_.reset();
  for (TransferPtr& read : reads_) read.reset();
  libusb_exit(context_);
}

void UsbTransport::wait(Duration most, TimePoint now) {
  if (handle_ == nullptr && now >= look_at_) look(now);
  mend();
  if (request_pending_) most = std::clamp(request_until_ - now, Duration::zero(), most);
  if (size_ == 0) handle_events(context_, most);
  settle(now);
}

void UsbTransport::look(TimePoint now) {
  look_at_ = now + kLookEvery;
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context_, &list);
  Refusal why = Refusal::none;
  for (ssize_t i = 0; i < count && handle_ == nullptr; ++i) {
    libusb_device_descriptor d{};
    if (!is_falcon(list[i], d)) continue;
    const Refusal refused = open(list[i]);
    if (why == Refusal::none) why = refused;
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  if (handle_ != nullptr) return attach();
  refuse(why);
}

// Leaves handle_ open if it is the one looked for and could be had. Only an open device tells its
// serial number; one that cannot be opened is taken to be it, so that the reason is said.
Refusal UsbTransport::open(libusb_device* device) {
  int error = libusb_open(device, &handle_);
  if (error != LIBUSB_SUCCESS) {
    handle_ = nullptr;
    return refusal(error);
  }
  if (has_serial()) {
    libusb_set_auto_detach_kernel_driver(handle_, 1);
    error = libusb_claim_interface(handle_, kInterface);
    if (error == LIBUSB_SUCCESS) return Refusal::none;
  }
  libusb_close(std::exchange(handle_, nullptr));
  return error == LIBUSB_SUCCESS ? Refusal::none : refusal(error);
}

bool UsbTransport::has_serial() const {
  if (serial_.empty()) return true;
  libusb_device_descriptor d{};
  libusb_get_device_descriptor(libusb_get_device(handle_), &d);
  return serial_number(handle_, d) == serial_;
}

void UsbTransport::refuse(Refusal why) noexcept {
  if (why != Refusal::none && why != refused_) push({.kind = EventKind::refused, .refusal = why});
  refused_ = why;
}

void UsbTransport::attach() noexcept {
  refused_ = Refusal::none;
  reads_failed_ = write_halted_ = false;
  mended_ = 0;
  push({.kind = EventKind::attached});
  for (std::size_t i = 0; i < kReads; ++i)
    libusb_fill_bulk_transfer(reads_[i].get(), handle_, kIn, read_bytes_[i].data(),
                              static_cast<int>(kUsbPacketBytes), heard, this, kNoTimeout);
  gone_ = !start_reads();
}

// Clears an endpoint that does not read or write any more, once nothing is pending on it.
void UsbTransport::mend() noexcept {
  if (handle_ == nullptr || gone_) return;
  if (!request_pending_ && std::exchange(write_halted_, false)) libusb_clear_halt(handle_, kOut);
  if (!reads_failed_) return;
  if (pending_reads_ > 0) return cancel_reads();
  reads_failed_ = false;
  const bool mended = ++mended_ <= kMostMended &&
                      libusb_clear_halt(handle_, kIn) == LIBUSB_SUCCESS && start_reads();
  gone_ = gone_ || !mended;
}

bool UsbTransport::start_reads() noexcept {
  return std::all_of(reads_.begin(), reads_.end(),
                     [this](auto& read) { return start_read(read.get()); });
}

bool UsbTransport::start_read(libusb_transfer* read) noexcept {
  const bool started = libusb_submit_transfer(read) == LIBUSB_SUCCESS;
  pending_reads_ += started;
  return started;
}

void UsbTransport::cancel_reads() noexcept {
  for (const TransferPtr& read : reads_) libusb_cancel_transfer(read.get());
}

void UsbTransport::submit(const Request& request, TimePoint now) noexcept {
  if (handle_ == nullptr || gone_) return;
  unsigned char* bytes = request_bytes_.data();
  if (request.is_control) {
    libusb_fill_control_setup(bytes, kVendorRequest, request.control.request, request.control.value,
                              0, 0);
    libusb_fill_control_transfer(request_.get(), handle_, bytes, done, this, kNoTimeout);
  } else {
    std::transform(request.data.view().begin(), request.data.view().end(), bytes,
                   [](std::byte b) { return std::to_integer<unsigned char>(b); });
    libusb_fill_bulk_transfer(request_.get(), handle_, kOut, bytes,
                              static_cast<int>(request.data.size), done, this, kNoTimeout);
  }
  const int error = libusb_submit_transfer(request_.get());
  request_pending_ = error == LIBUSB_SUCCESS;
  request_until_ = now + (request.is_control ? Duration(kControlTime) : Duration(kDataTime));
  if (error == LIBUSB_ERROR_NO_DEVICE)
    gone_ = true;
  else if (error != LIBUSB_SUCCESS)
    push({.kind = EventKind::failed});
}

void UsbTransport::done(libusb_transfer* t) {
  auto& self = *static_cast<UsbTransport*>(t->user_data);
  self.request_pending_ = false;
  if (t->status == LIBUSB_TRANSFER_NO_DEVICE) self.gone_ = true;
  if (self.gone_) return;
  const bool control = t->type == LIBUSB_TRANSFER_TYPE_CONTROL;
  if (!control && t->status == LIBUSB_TRANSFER_STALL) self.write_halted_ = true;
  // Bytes that had all left when this thread came late are sent, though they were given up.
  const bool sent =
      control ? t->status == LIBUSB_TRANSFER_COMPLETED : t->actual_length == t->length;
  self.push({.kind = sent ? EventKind::sent : EventKind::failed});
}

void UsbTransport::heard(libusb_transfer* t) {
  auto& self = *static_cast<UsbTransport*>(t->user_data);
  --self.pending_reads_;
  const bool completed = t->status == LIBUSB_TRANSFER_COMPLETED;
  if (t->status == LIBUSB_TRANSFER_NO_DEVICE) self.gone_ = true;
  if (self.gone_) return;
  if (completed && t->actual_length > 0) {
    self.mended_ = 0;
    Event event{.kind = EventKind::received};
    event.packet.size = static_cast<std::size_t>(t->actual_length);
    std::transform(t->buffer, t->buffer + t->actual_length, event.packet.bytes.begin(),
                   [](unsigned char b) { return std::byte{b}; });
    self.push(event);
  }
  self.reads_failed_ = self.reads_failed_ || !completed;
  if (!self.reads_failed_ && !self.start_read(t)) self.gone_ = true;
}

void UsbTransport::push(const Event& event) noexcept {
  const bool packet = event.kind == EventKind::received;
  if (size_ + (packet ? kReserved : 0) >= events_.size()) {
    ++dropped_;
    return;
  }
  events_[(first_ + size_++) % events_.size()] = event;
}

const Event* UsbTransport::next_event(TimePoint now) noexcept {
  settle(now);
  if (size_ == 0) return nullptr;
  event_ = events_[first_];
  first_ = (first_ + 1) % events_.size();
  --size_;
  return &event_;
}

// A request whose time is up is given up. A device that is gone is closed once no transfer of it is
// pending.
void UsbTransport::settle(TimePoint now) noexcept {
  if (request_pending_ && now >= request_until_) {
    request_until_ = TimePoint::max();  // once
    libusb_cancel_transfer(request_.get());
  }
  if (!gone_ || handle_ == nullptr) return;
  if (!request_pending_ && pending_reads_ == 0) return close();
  libusb_cancel_transfer(request_.get());
  cancel_reads();
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
