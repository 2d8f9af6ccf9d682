// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/experiments/hall_pictures.hpp"

namespace gatefly::experiments {

/// A gate to be found, or what was taken for one.
struct HallGate {
  std::uint64_t seed = 0;
  std::size_t picture = 0;
  Quad corners_px{};
  double score = 0.0;  ///< Score of a false alarm.
  bool hit = false;
  std::string cause;  ///< Cause of a miss; "false alarm".

  [[nodiscard]] bool is_false() const { return cause == "false alarm"; }
};

/// A contact sheet: what is around each miss or false alarm, enlarged.
class HallSheet {
 public:
  using Tiles = std::vector<drawing::Canvas>;

  explicit HallSheet(std::string title) : title_{std::move(title)} {}

  /// At most a few of a seed. @param wrong  false alarms, else misses.
  [[nodiscard]] static Tiles tiles_of(const HallSeed& hall, const std::vector<HallGate>& gates,
                                      bool wrong);
  void add(Tiles& tiles);
  [[nodiscard]] drawing::Canvas drawn() const;

 private:
  std::string title_;
  Tiles tiles_;
};

}  // namespace gatefly::experiments
