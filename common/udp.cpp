#include "common/udp.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <stdexcept>

#include "common/address.hpp"

namespace farhand {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

udp::endpoint to_endpoint(const UdpAddress& a) noexcept {
  if (a.v6) return {asio::ip::address_v6(a.bytes, a.scope), a.port};
  asio::ip::address_v4::bytes_type v4;
  std::copy_n(a.bytes.begin(), v4.size(), v4.begin());
  return {asio::ip::address_v4(v4), a.port};
}

UdpAddress from_endpoint(const udp::endpoint& e) noexcept {
  UdpAddress a{.port = e.port(), .v6 = e.address().is_v6()};
  if (a.v6) {
    const asio::ip::address_v6 v6 = e.address().to_v6();
    a.bytes = v6.to_bytes();
    a.scope = static_cast<std::uint32_t>(v6.scope_id());
  } else {
    const auto v4 = e.address().to_v4().to_bytes();
    std::copy(v4.begin(), v4.end(), a.bytes.begin());
  }
  return a;
}

[[noreturn]] void refuse(const std::string& what, const UdpAddress& address, const error_code& ec,
                         const std::string& remedy) {
  throw std::runtime_error("udp: cannot " + what + " " + to_string(address) + " (" + ec.message() +
                           "); " + remedy);
}

std::string bind_remedy(const error_code& ec) {
  if (ec == asio::error::address_in_use)
    return "another program has this port: stop it or choose another port";
  if (ec == asio::error::access_denied) return "choose a port of 1024 or above";
  return "choose an address of this host, or 0.0.0.0 for all of them";
}

timespec to_timespec(Duration d) noexcept {
  const auto whole = std::chrono::floor<std::chrono::seconds>(d);
  return {.tv_sec = static_cast<time_t>(whole.count()),
          .tv_nsec = static_cast<long>((d - whole).count())};
}

bool poll_until(std::span<pollfd> fds, TimePoint deadline) noexcept {
  for (;;) {
    const TimePoint now = std::chrono::steady_clock::now();
    const Duration left = std::max(deadline - now, Duration::zero());
    const timespec timeout = to_timespec(left);
    const int ready = ppoll(fds.data(), fds.size(), &timeout, nullptr);
    if (ready > 0) return true;
    if (ready == 0 && left == Duration::zero()) return false;
  }
}

// A connected socket keeps the address it first sent from, also when the host has lost it.
bool may_have_lost_its_address(const error_code& ec) noexcept {
  namespace errc = boost::system::errc;
  return ec == errc::invalid_argument || ec == errc::address_not_available ||
         ec == errc::network_unreachable || ec == errc::destination_address_required;
}

}  // namespace

UdpAddress parse_udp_address(const std::string& text) {
  const auto address = parse_address(text);
  error_code ec;
  const asio::ip::address host =
      address ? asio::ip::make_address(address->host, ec) : asio::ip::address();
  if (!address || ec)
    throw std::invalid_argument("udp: '" + text +
                                "' is not an address and port; write them as numbers, such as "
                                "10.0.0.2:5555 or [fe80::1%eth0]:5555");
  return from_endpoint({host, address->port});
}

std::string to_string(const UdpAddress& address) {
  const std::string host = to_endpoint(address).address().to_string();
  return (address.v6 ? "[" + host + "]" : host) + ":" + std::to_string(address.port);
}

struct UdpSocket::State {
  asio::io_context context;
  udp::socket socket{context};
  UdpAddress local;
  std::optional<UdpAddress> peer;
  udp::endpoint peer_endpoint;
  bool fixed = false;
  UdpCounters counters;
  int timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { close(timer); }

  // Sends from whatever address this host now has towards the peer.
  void reconnect(error_code& ec) noexcept {
    const sockaddr none{.sa_family = AF_UNSPEC, .sa_data = {}};
    ::connect(socket.native_handle(), &none, sizeof none);
    socket.connect(peer_endpoint, ec);
  }
};

UdpSocket::UdpSocket(const UdpAddress& local, const std::optional<UdpAddress>& fixed_peer)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  const udp::endpoint at = to_endpoint(local);
  error_code ec;
  s.socket.open(at.protocol(), ec);
  if (!ec) s.socket.non_blocking(true, ec);
  if (!ec && s.timer < 0) ec = error_code(errno, boost::system::system_category());
  if (ec) refuse("open a socket for", local, ec, "check that this host has such a network");
  s.socket.bind(at, ec);
  if (ec) refuse("bind", local, ec, bind_remedy(ec));
  if (fixed_peer) {
    set_peer(*fixed_peer);
    s.fixed = true;
    s.socket.connect(s.peer_endpoint, ec);
    if (ec) refuse("reach", *fixed_peer, ec, "check the peer's address, the cable and the routes");
  }
  s.local = from_endpoint(s.socket.local_endpoint());
}

UdpSocket::~UdpSocket() = default;
UdpSocket::UdpSocket(UdpSocket&&) noexcept = default;
UdpSocket& UdpSocket::operator=(UdpSocket&&) noexcept = default;

UdpAddress UdpSocket::local() const noexcept {
  return state_->local;
}
const std::optional<UdpAddress>& UdpSocket::peer() const noexcept {
  return state_->peer;
}
const UdpCounters& UdpSocket::counters() const noexcept {
  return state_->counters;
}

// The library's own option gives half of what the kernel counts.
std::size_t UdpSocket::receive_buffer() const noexcept {
  int size = 0;
  socklen_t length = sizeof size;
  getsockopt(state_->socket.native_handle(), SOL_SOCKET, SO_RCVBUF, &size, &length);
  return static_cast<std::size_t>(size);
}

void UdpSocket::set_peer(const UdpAddress& peer) noexcept {
  if (state_->fixed) return;
  state_->peer = peer;
  state_->peer_endpoint = to_endpoint(peer);
}

bool UdpSocket::send(std::span<const std::byte> datagram) noexcept {
  State& s = *state_;
  if (datagram.empty()) return false;
  const auto buffer = asio::buffer(datagram.data(), datagram.size());
  error_code ec = asio::error::not_connected;
  const auto attempt = [&] {
    if (s.fixed) s.socket.send(buffer, 0, ec);
    if (!s.fixed && s.peer) s.socket.send_to(buffer, s.peer_endpoint, 0, ec);
  };
  attempt();
  if (ec == asio::error::connection_refused) {  // about an earlier datagram; this one did not go
    ++s.counters.refused;
    attempt();
  }
  if (s.fixed && may_have_lost_its_address(ec)) {
    s.reconnect(ec);
    if (!ec) attempt();
  }
  if (!ec) ++s.counters.sent;
  if (ec == asio::error::would_block) ++s.counters.send_would_block;
  if (ec && ec != asio::error::would_block) ++s.counters.send_failed;
  return !ec;
}

bool UdpSocket::send_to(std::span<const std::byte> datagram, const UdpAddress& to) noexcept {
  const std::optional<UdpAddress> peer = state_->peer;
  set_peer(to);
  const bool sent = send(datagram);
  if (peer) set_peer(*peer);
  if (!peer) state_->peer.reset();
  return sent;
}

std::optional<UdpSocket::Received> UdpSocket::receive(std::span<std::byte> buffer) noexcept {
  State& s = *state_;
  udp::endpoint from;
  error_code ec;
  const auto attempt = [&] {
    return s.socket.receive_from(asio::buffer(buffer.data(), buffer.size()), from, 0, ec);
  };
  std::size_t size = attempt();
  if (ec == asio::error::connection_refused) {
    ++s.counters.refused;
    size = attempt();
  }
  // While no address leads to the peer, the kernel lets strangers in.
  constexpr int kMostStrangers = 64;
  for (int i = 0; !ec && s.fixed && from != s.peer_endpoint; ++i) {
    if (i == kMostStrangers) return std::nullopt;
    size = attempt();
  }
  if (ec == asio::error::would_block) return std::nullopt;
  if (ec) {
    ++s.counters.receive_failed;
    return std::nullopt;
  }
  ++s.counters.received;
  return Received{size, from_endpoint(from)};
}

bool UdpSocket::wait_readable(TimePoint deadline) noexcept {
  pollfd fd{.fd = state_->socket.native_handle(), .events = POLLIN, .revents = 0};
  return poll_until(std::span(&fd, 1), deadline);
}

bool UdpSocket::spin_readable(TimePoint deadline) noexcept {
  constexpr TimePoint kAtOnce{};
  while (!wait_readable(kAtOnce))
    if (std::chrono::steady_clock::now() >= deadline) return false;
  return true;
}

// A deadline that is over is never the epoch, which would stop the timer.
void UdpSocket::set_deadline(TimePoint deadline) noexcept {
  const Duration since = std::max(deadline.time_since_epoch(), Duration(1));
  const itimerspec at{.it_interval = {}, .it_value = to_timespec(since)};
  timerfd_settime(state_->timer, TFD_TIMER_ABSTIME, &at, nullptr);
}

bool UdpSocket::wait_readable() noexcept {
  std::array<pollfd, 2> fds{
      pollfd{.fd = state_->socket.native_handle(), .events = POLLIN, .revents = 0},
      pollfd{.fd = state_->timer, .events = POLLIN, .revents = 0}};
  while (poll(fds.data(), fds.size(), -1) < 0) {
  }
  return fds[0].revents != 0;
}

bool UdpSocket::wait_readable(UdpSocket& a, UdpSocket& b, TimePoint deadline) noexcept {
  std::array<pollfd, 2> fds{
      pollfd{.fd = a.state_->socket.native_handle(), .events = POLLIN, .revents = 0},
      pollfd{.fd = b.state_->socket.native_handle(), .events = POLLIN, .revents = 0}};
  return poll_until(fds, deadline);
}

}  // namespace farhand
