#include "common/address.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <charconv>

namespace farhand {
namespace {

std::optional<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return port;
}

// Whether the host is loopback; nothing if it is no numeric IPv4 address.
std::optional<bool> loopback4(const std::string& host) {
  in_addr a{};
  if (inet_pton(AF_INET, host.c_str(), &a) != 1) return {};
  return (ntohl(a.s_addr) >> 24) == 127;
}

std::optional<bool> loopback6(const std::string& host) {
  in6_addr a{};
  const auto zone = host.find('%');
  if (zone + 1 == host.size() || inet_pton(AF_INET6, host.substr(0, zone).c_str(), &a) != 1)
    return {};
  return IN6_IS_ADDR_LOOPBACK(&a) || (IN6_IS_ADDR_V4MAPPED(&a) && a.s6_addr[12] == 127);
}

}  // namespace

std::optional<Address> parse_address(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos || text.find('\0') != std::string_view::npos) return {};
  const auto port = parse_port(text.substr(colon + 1));
  std::string host(text.substr(0, colon));
  const bool ipv6 = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (ipv6) host = host.substr(1, host.size() - 2);
  if (host == "localhost") host = "127.0.0.1";
  const auto loopback = ipv6 ? loopback6(host) : loopback4(host);
  if (!port || !loopback) return {};
  return Address{.host = std::move(host), .port = *port, .ipv6 = ipv6, .loopback = *loopback};
}

}  // namespace farhand
