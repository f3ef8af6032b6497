// host:port as people write it: a numeric IPv4 address, a numeric IPv6 address in brackets, or
// localhost (127.0.0.1). Names are not looked up, so a scene means the same on every machine and
// starting needs no resolver.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace farhand {

struct Address {
  std::string host;  // numeric, without brackets, an IPv6 zone (%eth0) included
  std::uint16_t port = 0;
  bool ipv6 = false;
  bool loopback = false;  // reaches this machine only
};

// Nothing for anything else: no port, a port above 65535, spaces, a name.
std::optional<Address> parse_address(std::string_view text);

}  // namespace farhand
