// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

namespace gatefly::test {

inline int cases_left_out = 0;

/// A property returns this for a draw that it says nothing about: `if (!seen) return not_a_case();`
inline void not_a_case() { ++cases_left_out; }

/// Runs `property` on `cases` fresh generators; a failure prints the seed that reproduces it. At
/// least half of them must be cases.
template <class Property>
void for_all(int cases, Property&& property, std::uint64_t base_seed = 1) {
  cases_left_out = 0;
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = base_seed + static_cast<std::uint64_t>(i);
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng{seed};
    property(rng);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_LE(2 * cases_left_out, cases) << "the property says nothing about most of its cases";
}

}  // namespace gatefly::test
