// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

namespace gatefly::test {

/// Runs `property` on `cases` fresh generators; a failure prints the seed that reproduces it.
template <class Property>
void for_all(int cases, Property&& property, std::uint64_t base_seed = 1) {
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = base_seed + static_cast<std::uint64_t>(i);
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Rng rng{seed};
    property(rng);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace gatefly::test
