// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/pixel_evidence.hpp"
#include "gatefly/detection/quad.hpp"

namespace gatefly::tuning {

/// How far a side of a gate bows beside its chord. Lengths in widths of its picture, places off the
/// picture's middle, so that pictures of several sizes speak for one lens.
struct BowedSide {
  Eigen::Vector2d from, to;  ///< Ends of the bar's middle line, clockwise around the gate.
  double sag = 0.0;          ///< At the middle, positive to the right of from → to: inwards.
  double sigma = 1.0;        ///< One standard deviation of sag.
  std::size_t gate = 0;      ///< Sides of one gate share what is wrong with it.
};

/// The sides of a gate that show well enough to say how far they bow.
/// @param bars_px  middle lines of its bars, good to some pixels. @param bar  their width / side.
/// @param evidence  of `image`, in the gate's colour.
[[nodiscard]] std::vector<BowedSide> bowed_sides(const Image& image, const PixelEvidence& evidence,
                                                 const Quad& bars_px, double bar);

/// The lens that the gates of a set of pictures show, as an equidistant one. Straight bars tell how it
/// bends, but nothing about its focal length.
struct GateLens {
  enum class Says {
    kNothing,   ///< Too few or too small gates.
    kStraight,  ///< No bend that would move a side.
    kBent,
  };
  Says says = Says::kNothing;
  double angle = 0.0;        ///< Across the picture's width [rad], of kBent.
  double angle_sigma = 0.0;  ///< One standard deviation [rad].
  double widest = 0.0;       ///< No wider angle is within two standard deviations [rad].
  int gates = 0, sides = 0;  ///< That were measured.
  bool knows_center = false;
  /// The lens' centre off the picture's middle, in its widths; 0 where it cannot be known.
  Eigen::Vector2d center{0, 0};
  Eigen::Vector2d center_sigma{0, 0};

  /// For the detector; none of kNothing.
  [[nodiscard]] PictureLens picture_lens() const;
};

/// Plumb lines (Brown 1971): straight bars must be straight without the lens. One angle, least
/// squares against outliers; its sigma from how far the gates differ. The centre is the picture's
/// middle unless the gates clearly say another one.
[[nodiscard]] GateLens fit_lens(std::span<const BowedSide> sides);

}  // namespace gatefly::tuning
