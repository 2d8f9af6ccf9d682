// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/sim/told_apart.hpp"

// What a detector made of pictures, look by look.

namespace gatefly::measuring {

/// One thing in one picture, and whether the detector took it for a gate.
struct Look {
  int seed = 0;    ///< Its number from 0, among seeds or among sets of real pictures.
  int window = 0;  ///< Consecutive pictures; numbers are unique.
  int step = 0;    ///< In the window.
  int which = 0;   ///< The same thing has the same number.
  double side_px = 0.0;
  bool hit = false;
  double fitness = 0.0;  ///< Of a hit, as all below.
  Quad truth{}, seen{};
  std::array<bool, 4> in_view{};  ///< Of kCut: which corners are.
};

/// What is looked at.
enum class Kind {
  kGate,        ///< The largest whole gate; a hit shares 70 % of both areas.
  kOther,       ///< Smaller whole gates beside it.
  kAslant,      ///< Whole ones that are too small or seen too much from the side to count.
  kHidden,      ///< Those with two or three corners in view.
  kCrooked,     ///< Any of these, where a "hit" shares less: a wrong frame.
  kTwoGates,    ///< A frame made of two gates' bars.
  kDecoy,       ///< Something of the gate's colour.
  kPlace,       ///< A spot of the room (sim::places_of): how many are in view; hits are elsewhere.
  kLower,       ///< The lower corners of a gate cut off above.
  kBars,        ///< A near gate's side bars.
  kFalseLower,  ///< Picture by picture: lower corners that are none.
  kFalseBars,
  kCut,       ///< A gate that the border cuts, within reach, by its corners in view.
  kFalseCut,  ///< Picture by picture: corners of one that are none.
  kCount
};
constexpr std::size_t kKinds = static_cast<std::size_t>(Kind::kCount);
[[nodiscard]] const char* name_of(Kind kind);

/// A false alarm that is none of the things above.
struct Alarm {
  int seed = 0, window = 0, step = 0;
  double fitness = 0.0, side_px = 0.0;
  Eigen::Vector3d direction_E{0, 0, 0};
  /// Pictures of the window later than this by 1, 2, ... in which the place is in view, and those
  /// of them with an alarm there.
  std::array<bool, 12> in_view{}, again{};
};

/// The light of a seed.
struct SeedLight {
  double hue = 0.0;         ///< Of the gates against the nominal one [rad].
  double brightness = 0.0;  ///< Mean of the logarithms of the light groups' gains.
  double exposure = 0.0;    ///< Logarithm of the exposure's target.
};

/// Everything one detector made of some pictures.
struct Looks {
  int pictures = 0;
  std::array<std::vector<Look>, kKinds> of;
  std::vector<Alarm> alarms;
  std::map<int, SeedLight> lights;
  /// Of every detection what can be read of it: of gates, and of what is none.
  std::vector<sim::Fields> of_gates, of_others;

  [[nodiscard]] std::vector<Look>& operator[](Kind kind) {
    return of[static_cast<std::size_t>(kind)];
  }
  [[nodiscard]] const std::vector<Look>& operator[](Kind kind) const {
    return of[static_cast<std::size_t>(kind)];
  }
};

/// The two detectors that ideal vision knows.
enum Detector : std::size_t { kOurs, kPaper, kDetectors };
using LooksOfBoth = std::array<Looks, kDetectors>;

/// Side of a square of that area [px].
[[nodiscard]] double side_of(const Quad& quad);

}  // namespace gatefly::measuring
