// OpenSSL's objects, freed by themselves.
#pragma once

#include <memory>

namespace farhand {

template <auto kFree>
struct Freed {
  template <typename T>
  void operator()(T* t) const noexcept {
    kFree(t);
  }
};

}  // namespace farhand
