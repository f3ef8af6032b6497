// What a tick is told of the other side: the newest message and how much it can still be trusted.
// Filled by the shell from the link, so that the tick knows no clock but `now` and no socket.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace farhand {

template <typename Message>
struct Peer {
  const Message* newest = nullptr;      // nullptr: none since the connection began
  bool connected = false;               // heard within link.lost_ms
  Duration age = Duration::max();       // since the newest arrived, on our clock
  bool synced = false;                  // its clock is known, and so how long a message takes
  Duration echo_age = Duration::max();  // of our message that it answers; max before one
  Duration sent{};                      // the newest, on the peer's clock since its epoch
  std::uint64_t session = 0;            // the peer's
};

// As the link sees it at `now`; silence beyond `lost` ends the connection. `link` is a Link<Out,
// Message>.
template <typename Message, typename AnyLink>
Peer<Message> peer(const AnyLink& link, TimePoint now, Duration lost) noexcept {
  const auto* newest = link.newest();
  if (newest == nullptr) return {};
  const Duration age = now - newest->received;
  return {.newest = &newest->message,
          .connected = age <= lost,
          .age = age,
          .synced = newest->transit_known,
          .echo_age = newest->echo_sequence == 0 ? Duration::max()
                                                 : now.time_since_epoch() - newest->echo_sent,
          .sent = newest->sent,
          .session = link.peer() ? link.peer()->session : 0};
}

}  // namespace farhand
