// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "gatefly/experiments/bench/picture.hpp"
#include "gatefly/geometry/rng.hpp"

namespace gatefly::bench {

struct WorstPicture {
  Pattern pattern;
  double time_us = 0.0;
};

/// The pattern that takes longest: random ones of every kind, then steps from the slowest of each.
/// @param look  what is measured; @param tries  pictures of each kind. Same seed, same tries.
[[nodiscard]] WorstPicture worst_picture(const std::function<void(const Picture&)>& look, int tries,
                                         Rng& rng, const std::function<bool()>& stopped);

}  // namespace gatefly::bench
