// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "gatefly/sim/gates_in_view.hpp"
#include "gatefly/sim/told_apart.hpp"

namespace gatefly::sim {

/// Shares of a seed's light, and of what does not change from picture to picture, in whether
/// something is found: parts of the variance of a standard normal number. The rest is each
/// picture's own.
struct Staying {
  double seed = 0.0;  ///< The same for the whole seed, for all things of a kind.
  double row = 0.0;   ///< Stays with one thing, for about `time`.
  double time = 0.1;  ///< Its correlation falls to 1/e in that time [s].
};

/// Quantiles of a quantity: its least value, ten, twenty ... per cent, its greatest.
using Quantiles = std::array<double, 11>;

/// Whole gates smaller than `below_px` in the picture, by the square root of their area.
struct SizeBin {
  double below_px = 0.0;
  double rate = 0.0;    ///< Part of them that is found.
  Quantiles fitness{};  ///< Fitness of those.
};

/// Things of a kind that are taken for gates now and then.
struct Finds {
  double rate = 0.0;  ///< Part of the things in a picture that is taken for a gate.
  Staying staying;
  Quantiles fitness{};
};

/// Errors of corners against their true places. Standard deviations [px].
struct CornerErrors {
  double together = 0.0;  ///< Shift of all four, each axis.
  double size = 0.0;      ///< Scale of the frame's half side.
  double own = 0.0;       ///< Rest of each corner, each axis.
  /// Part of the variance of the first two that stays for about `time`.
  double stays = 0.0, time = 0.1;
  double outlier_rate = 0.0;                     ///< Part of the corners that are off by more ...
  double outlier_low = 0.0, outlier_high = 0.0;  ///< ... by this much.
};

/// Pairs of corners or bars of a gate that does not fit into the picture.
struct Parts {
  double rate = 0.0;  ///< Part of the pairs in view that is found.
  Staying staying;
  double sigma_px = 0.0;
  double false_rate = 0.0;  ///< Part of the pictures with one that is none.
  Staying false_staying;
};

/// Gates of one kind that the border cuts, smaller than `below_px` (GateView::side_px).
struct CutBin {
  double below_px = 0.0;
  double rate = 0.0;      ///< Part of them of which all corners in view are found.
  double sigma_px = 0.0;  ///< Error of each corner, each axis.
};
using CutBins = std::array<CutBin, 3>;  ///< Ascending.

/// Wide gates that the border cuts, by any two or three corners of them.
struct Cuts {
  std::array<CutBins, kCutKinds> kinds{};  ///< By CutKind.
  Staying staying;
  double false_rate = 0.0;  ///< Part of the pictures with one that is none.
  Staying false_staying;
};

/// A detector in numbers: all that ideal vision knows about it.
struct DetectorStatistics {
  std::array<SizeBin, 5> gates;   ///< The largest whole one of a picture, by its size, ascending.
  std::array<SizeBin, 5> others;  ///< Smaller whole ones beside it.
  Finds aslant;                   ///< Whole ones, too small or seen too much from the side.
  Finds hidden;                   ///< Those with two or three corners in view.
  Staying staying;
  CornerErrors corners;
  Finds crooked;                                 ///< Gates of which a wrong frame is found ...
  double crooked_low = 0.0, crooked_high = 0.0;  ///< ... one side off by this part of it.
  Finds two_gates;                               ///< Frames made of the bars of two gates.
  Finds decoys;                                  ///< Things of the gate's colour.
  Finds places;                                  ///< Spots of the room.
  Quantiles alarm_side_px{};                     ///< Sizes of false alarms at decoys and places.
  Cuts cuts{};                                   ///< Instead of `lower` where gates are wide.
  Parts lower;  ///< The lower corners of gates cut off above, within reach.
  Parts bars;   ///< Side bars, within reach; the error is that across.
  /// How well each field of a detection tells gates from what is none: the real detector's on
  /// rendered pictures. Ideal vision may tell no more.
  Fields told{};
};

/// The gates that a table was measured with.
enum class GateBuild {
  kThin,  ///< Gates of 1 m, bars of 5 cm, by the Bebop's camera.
  kWide,  ///< 2.7 m, boards of 0.6 m, by a camera of 640 px tilted up: cameras/grandprix.toml.
};
/// The table that fits these gates best, by the width of their bars.
[[nodiscard]] GateBuild build_of(std::span<const world::WorldGate> gates);

/// Measured: tools/detector_statistics, which writes detector_tables.hpp and wide_gates_table.hpp.
/// The paper's detector has the table of thin gates only.
/// @throws std::invalid_argument for another name than "ours" and "paper".
[[nodiscard]] const DetectorStatistics& statistics_of(const std::string& detector,
                                                      GateBuild build = GateBuild::kThin);

}  // namespace gatefly::sim
