// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "looks.hpp"

namespace gatefly::measuring {

/// Pictures of a course's seeds: windows of consecutive ones, along races flown by ideal vision.
struct Order {
  std::string track;
  std::vector<std::string> configs{};  ///< The camera, if not the Bebop's.
  std::uint64_t first_seed = 1001;
  int seeds = 20;
  int windows = 3;    ///< For each seed, evenly spread over the race.
  int pictures = 30;  ///< For each window.
  /// Ideal vision in place of pictures: measures what was drawn by the rules of what is measured.
  bool ideal = false;
  bool paper = true;  ///< The paper's detector looks, too.
};

/// Adds what both detectors see on a course. Seeds and windows are numbered on.
void look_at(const Order& order, LooksOfBoth& looks);

}  // namespace gatefly::measuring
