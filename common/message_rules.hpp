// What a message must be to be sent or taken: every number finite, quaternions unit to
// kQuaternionTolerance, energies of waves not negative, stamps up to kMaxStamp, sequences from 1,
// and of a hello only what its role may say.
#pragma once

#include "common/wire.hpp"

namespace farhand {

bool valid(const Hello& hello) noexcept;
bool valid(const MasterToSlave& message) noexcept;
bool valid(const SlaveToMaster& message) noexcept;
bool valid(const Header& header) noexcept;

}  // namespace farhand
