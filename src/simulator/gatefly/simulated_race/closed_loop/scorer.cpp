// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/scorer.hpp"

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/sim/body_state.hpp"

namespace gatefly::simulated_race {

std::optional<Quad> Scorer::visible_gate(const sim::BodyPose& pose, const world::WorldGate& gate,
                                         const sim::Sight* scene) const {
  const Eigen::Matrix3d R_EB = sim::R_EB_of(pose.q_EB);
  const Eigen::Matrix3d R_EC = R_EB * camera_mount(camera_.tilt_down).matrix;
  const Eigen::Vector3d eye_E = pose.p_EB + R_EB * camera_.p_BC;
  const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
  const double distance = (gate.p_EG - eye_E).norm();
  if (gate.missing || (gate.hidden_beyond > 0.0 && distance > gate.hidden_beyond))
    return std::nullopt;
  // from behind it is not to be flown
  if (R_EG.col(0).dot(gate.p_EG - eye_E) < 0.2) return std::nullopt;
  const double ahead = near_face(gate.side, gate.bar, gate.depth);
  const Eigen::Vector3d face_E = gate.p_EG - ahead * R_EG.col(0),
                        eye_G = R_EG.transpose() * (eye_E - gate.p_EG);
  const auto corners_G = gate_corners_G(gate.side);
  Quad quad;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner_E =
        face_E + R_EG * corners_G[i] +
        R_EG * outline_shift_G(corners_G[i], eye_G, ahead, CornerOf::kFrame);
    const auto px = camera_.lens.project(R_EC.transpose() * (corner_E - eye_E));
    // The upright picture's size counts, however it is stored.
    if (!px || px->x() < 0 || px->y() < 0 || px->x() > camera_.width() - 1 ||
        px->y() > camera_.height() - 1)
      return std::nullopt;
    quad[i] = *px;
    // A little before the corner, so that the gate does not hide itself.
    const Eigen::Vector3d before_E = corner_E + 0.12 * (eye_E - corner_E).normalized();
    if (scene != nullptr && scene->occluded(eye_E, before_E)) return std::nullopt;
  }
  return quad;
}

std::string Scorer::taken_of(const sim::BodyPose& pose, const Sighting& sighting,
                             int target) const {
  if (sighting.source == Sighting::Source::kNone || sighting.used < 0) return "";
  const Quad& used = sighting.detections[static_cast<std::size_t>(sighting.used)].corners_px;
  const auto covers = [&](const world::WorldGate& gate) {
    const auto there = visible_gate(pose, gate, nullptr);
    return there && overlaps(used, *there, 0.5);
  };
  const auto wanted = static_cast<std::size_t>(target);
  if (covers(world_.gates[wanted])) return "";
  for (std::size_t i = 0; i < world_.gates.size(); ++i)
    if (covers(world_.gates[i])) return "gate " + std::to_string(i + 1);
  for (std::size_t i = 0; i < world_.false_gates.size(); ++i)
    if (covers(world_.false_gates[i])) return "false gate " + std::to_string(i + 1);
  return "no gate";
}

void Scorer::score(const sim::BodyPose& pose, const Sighting& sighting, int target,
                   const sim::Sight& scene) {
  ++frames_, careful_ += sighting.careful;
  const world::WorldGate& gate_to_fly = world_.gates[static_cast<std::size_t>(target)];
  wanted_ = visible_gate(pose, gate_to_fly, &scene);
  with_gate_ += wanted_.has_value();
  bool hit = false;
  for (const auto& detection : sighting.detections) {
    if (wanted_ && !hit && overlaps(detection.corners_px, *wanted_, 0.7)) {
      hit = true;
      continue;
    }
    bool is_gate = false;
    for (const auto* gates : {&world_.gates, &world_.false_gates})
      for (const auto& gate : *gates) {
        const auto other = visible_gate(pose, gate, nullptr);
        is_gate = is_gate || (other && overlaps(detection.corners_px, *other, 0.5));
      }
    false_ += !is_gate;
  }
  true_ += hit;
}

}  // namespace gatefly::simulated_race
