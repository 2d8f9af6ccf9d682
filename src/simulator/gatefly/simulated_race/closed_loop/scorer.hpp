// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "gatefly/race/pilot.hpp"
#include "gatefly/sim/camera.hpp"

namespace gatefly::simulated_race {

/// Compares what the pilot saw with what was there to see.
///
/// A hit covers 70 % of both areas, its own and the target's, once a picture. What covers half of
/// any gate before the camera, hidden or not, is no false positive: the pilot may look at others.
class Scorer {
 public:
  Scorer(const world::World& world, const world::CameraTruth& camera)
      : world_{world}, camera_{camera} {}

  /// One delivered frame, exposed around `pose`.
  void score(const sim::BodyPose& pose, const Sighting& sighting, int target,
             const sim::Sight& scene);

  /// Name of the gate that corrected the filter, when it was not the target: "gate 2", "false gate
  /// 1", "no gate"; "" when it was, or when only a part of a gate was used.
  [[nodiscard]] std::string taken_of(const sim::BodyPose& pose, const Sighting& sighting,
                                     int target) const;

  /// The target in the last frame: nullopt when it was not whole or hidden.
  [[nodiscard]] const std::optional<Quad>& wanted() const { return wanted_; }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] int frames_with_gate() const { return with_gate_; }  ///< Target whole and unhidden.
  [[nodiscard]] int true_positives() const { return true_; }
  /// Detections that are no gate at all.
  [[nodiscard]] int false_positives() const { return false_; }
  /// Frames that the pilot searched carefully.
  [[nodiscard]] int careful() const { return careful_; }

  /// Corners of a gate in the picture; nullopt unless all are inside and unhidden.
  [[nodiscard]] std::optional<Quad> visible_gate(const sim::BodyPose& pose,
                                                 const world::WorldGate& gate,
                                                 const sim::Sight* scene) const;

 private:
  world::World world_;
  world::CameraTruth camera_;
  std::optional<Quad> wanted_;
  int frames_ = 0, with_gate_ = 0, true_ = 0, false_ = 0, careful_ = 0;
};

}  // namespace gatefly::simulated_race
