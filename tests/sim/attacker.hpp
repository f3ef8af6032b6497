// Somebody on the network without the key, and a second master that has it (or needs none).
#pragma once

#include <array>
#include <string>
#include <unordered_set>
#include <vector>

#include "common/link.hpp"
#include "common/random.hpp"
#include "tests/loop/loopback.hpp"

namespace farhand {

// Keeps some of what it overhears, sends it again, changes it, or makes things up.
class Attacker {
 public:
  Attacker(std::uint64_t seed, bool secure) : random_(seed), secure_(secure) {}

  void overhear(Side to, std::span<const std::byte> datagram);
  // One tick; rate in datagrams per tick.
  void replay(Loopback& loop, double rate);
  void forge(Loopback& loop, double rate);
  // It made this one up.
  bool made(std::span<const std::byte> datagram) const;

 private:
  struct Capture {
    Side to = Side::slave;
    std::vector<std::byte> bytes;
  };
  int count(double rate);
  const Capture* pick();
  std::vector<std::byte> forged();

  Random random_;
  bool secure_;
  std::array<Capture, 256> kept_;
  std::uint64_t heard_ = 0;
  std::unordered_set<std::string> made_;
};

// Says hello, lets go, presses, and moves about; hears what goes to the master's side.
class SecondMaster {
 public:
  SecondMaster(std::uint64_t session, std::uint64_t scene_hash)
      : link_({.session = session, .scene_hash = scene_hash}) {}

  void tick(Loopback& loop);
  void hear(std::span<const std::byte> datagram, TimePoint now) { link_.receive(datagram, now); }

 private:
  MasterLink link_;
  std::uint64_t ticks_ = 0;
};

}  // namespace farhand
