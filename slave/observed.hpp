// The slave as others may look at it: fed from the recorder's thread, on a socket of its own.
#pragma once

#include "common/observers.hpp"
#include "common/udp.hpp"
#include "slave/loop.hpp"

namespace farhand {

class ObservedSlave {
 public:
  // Throws as UdpSocket does.
  ObservedSlave(const UdpAddress& local, const std::optional<Credentials>& credentials,
                std::uint64_t scene_hash);

  // Now and then answers who asked meanwhile, with this record.
  void add(const SlaveRecord& record);

 private:
  UdpSocket socket_;
  Observers observers_;
  std::uint64_t scene_hash_;
  TimePoint next_{};
};

}  // namespace farhand
