// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search_window.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/race/association.hpp"

namespace gatefly {

/// A gate as a picture that has just arrived should show it, by what the filter believes.
struct ExpectedGate {
  Quad bars_px;         ///< Middle lines of its bars.
  double side_px;       ///< Its upright sides.
  double facing;        ///< Cosine between its axis and the way to it.
  SearchWindow window;  ///< Three standard deviations around it, of place and attitude.
  bool shows_whole;     ///< Little enough is beyond the border for all four corners to be found.
};

/// Projects a gate that has a slot, seen from the side the drone is on. [ours]
/// @param ago  The picture was exposed so long before now() [s].
/// @return nullopt: behind the lens, out of the picture, or seen too much from aside.
[[nodiscard]] std::optional<ExpectedGate> expected_gate(const eskf::ErrorStateFilter& filter,
                                                        int slot, double ago,
                                                        const PictureClock& picture);

/// The standard deviation of the drone's place along the least certain axis [m].
[[nodiscard]] double place_sigma(const eskf::ErrorStateFilter& filter);

}  // namespace gatefly
