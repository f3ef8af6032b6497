// What the guards of both sides tell each other: energy that went into the network at the sender,
// since its session began, of translation and of rotation.
#pragma once

namespace farhand {

struct PortEnergies {
  double translation = 0;  // [J]
  double rotation = 0;
};

}  // namespace farhand
