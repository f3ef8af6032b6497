// For INSTANTIATE_TEST_SUITE_P: a test of the link with a key and with certificates.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/test_credentials.hpp"

namespace farhand {

inline const auto kBothProofs = testing::Values(Proof::key, Proof::certificates);

inline std::string proof_name(const testing::TestParamInfo<Proof>& info) {
  return info.param == Proof::key ? "Key" : "Certificates";
}

}  // namespace farhand
