// A scene that must be refused. '@' stands where the message must point, just before the line and
// column it names; it is taken out before the scene is read.
#pragma once

#include <string>
#include <vector>

namespace farhand {

struct BrokenScene {
  std::string text;
  const char* field;
  const char* says;  // part of the message: what is wrong, or the remedy
};

}  // namespace farhand
