// SPDX-License-Identifier: Apache-2.0
// The pilot's eye: from a picture to corrections of position and heading.
#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly {
namespace {

constexpr double kBlind = 1.0;           // without a fix for this long, a leg was flown blind [s]
constexpr double kOpenGateFrom = 3.5;    // nearer than this the upper bar may be cut off [m]
constexpr double kLongLeg = 2.5;         // shorter ones say nothing about heading [m]

}  // namespace

GateDetections Pilot::whole_gates(const Sensors& sensors, Effort effort) {
  if (sensors.seen) return sensors.seen->gates;
  const Image& image = *sensors.image;
  GateDetections whole;
  for (const GateDetection& gate : effort == Effort::kAll ? detector_.detect_all(image, config_.gate_color) : detector_.detect(image, config_.gate_color))
    if (gate.whole) (void)whole.push_back(gate);
  return whole;
}

void Pilot::look(const Sensors& sensors) {
  sighting_ = {};
  if (!sensors.seen && sensors.image->empty()) return;
  image_width_ = sensors.seen ? sensors.seen->image_width : sensors.image->width();
  if (std::holds_alternative<OnGround>(phase_) || std::holds_alternative<Land>(phase_) ||
      std::holds_alternative<Landed>(phase_))
    return;
  sighting_.detections = whole_gates(sensors, Effort::kSure);
  sighting_.seen = !sighting_.detections.empty();

  doubt_heading_after_blind_leg();
  correct_with_best_gate();
  const bool was_quick = sighting_.seen && sighting_.detections[0].method == DetectionMethod::kSnake && !sensors.seen;
  if (sighting_.source == Sighting::Source::kNone && was_quick) {
    // Another gate stood out; the one that is looked for may be there, too.
    sighting_.detections = whole_gates(sensors, Effort::kAll);
    correct_with_best_gate();
  }
  const double x = filter_.position().x();
  if (sighting_.source == Sighting::Source::kNone && x > -kOpenGateFrom && x < 0.0) correct_with_parts(sensors);
}

// Near the gate parts of it are enough: the lower corners, then the side bars.
void Pilot::correct_with_parts(const Sensors& sensors) {
  const bool near = filter_.position().x() > -config_.pose.max_bars_distance;
  std::optional<GateBars> bars;
  if (sensors.seen) {
    sighting_.open = sensors.seen->open, bars = sensors.seen->bars;
  } else if (const auto part = parts_.detect(*sensors.image, config_.gate_color)) {
    sighting_.open = part->lower_corners(), bars = part->bars;
  }
  if (sighting_.open) correct_with_lower_corners(*sighting_.open);
  if (sighting_.source != Sighting::Source::kNone || !near) return;
  sighting_.bars = bars;
  if (bars) correct_with_bars(*bars);
}

// The candidate that fits best to where the gate should be.
void Pilot::correct_with_best_gate() {
  int best = -1;
  double best_distance2 = 1e9;
  for (std::size_t i = 0; i < sighting_.detections.size(); ++i) {
    const GateDetection& candidate = sighting_.detections[i];
    const Past then = past(capture_time(center(candidate.corners_px).x()));
    const auto fix = fix_of(candidate, then);
    if (!fix || belongs_to_another_gate(candidate)) continue;
    const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
    const double distance2 = filter_.distance2(*fix, moved);
    if (distance2 < best_distance2) best = static_cast<int>(i), best_distance2 = distance2;
  }
  if (best >= 0 && correct_with(sighting_.detections[static_cast<std::size_t>(best)])) sighting_.used = best;
}

bool Pilot::fuse(const Fix& fix, const Eigen::Vector3d& moved, Sighting::Source source) {
  const double innovation2 = filter_.distance2(fix, moved);
  if (filter_.correct(fix, moved) == Fusion::kRefused) return false;
  const Eigen::Matrix3d R_EG = rotation_z(gate().yaw_EG);
  FixOnCourse& used = sighting_.fix.emplace();
  used.p_EB = gate().p_EG + R_EG * (fix.p_GB + moved);
  used.covariance = R_EG * fix.covariance * R_EG.transpose();
  used.has_height = fix.has_height;
  if (fix.yaw_error) used.yaw = wrap_angle(ahrs_.attitude().yaw + *fix.yaw_error);
  used.yaw_sigma = std::sqrt(fix.yaw_variance + config_.gate_yaw_sigma * config_.gate_yaw_sigma);
  sighting_.innovation2 = innovation2;
  sighting_.innovation_dof = fix.has_height ? 3 : 2;
  last_fix_ = time_;
  heading_doubt_ = 0.0;
  anchor_E_ = p_EB();
  sighting_.source = source;
  return true;
}

std::optional<Fix> Pilot::fix_of(const GateDetection& seen, const Past& then) const {
  return map_fix_from_corners(seen.corners_px, R_GB(then.R_EB), gate().side, config_.camera, pose_params());
}

PoseParams Pilot::pose_params() const {
  PoseParams params = config_.pose;
  params.attitude_sigma = std::hypot(config_.pose.attitude_sigma, ahrs_.tilt_sigma());
  params.heading_sigma = std::hypot(ahrs_.heading_sigma(), config_.gate_yaw_sigma);
  return params;
}

void Pilot::correct_heading(double error, double variance) {
  const double before = ahrs_.attitude().yaw;
  ahrs_.correct_heading(error, variance);
  // The past was off by as much.
  const Eigen::Matrix3d turn = rotation_z(wrap_angle(ahrs_.attitude().yaw - before));
  for (auto& moment : history_) moment.R_EB = turn * moment.R_EB;
}

// A leg flown blind on a heading that is off by δ ends δ ẑ × p₀ beside where it should, p₀ being where it
// began, seen from the next gate. Before the gate comes into view that belongs into the covariance ...
void Pilot::doubt_heading_after_blind_leg() {
  if (heading_doubt_ > 0.0 || time_ - last_fix_ < kBlind || last_fix_ < 0.0) return;
  const Eigen::Vector3d p0 = rotation_z(-gate().yaw_EG) * (anchor_E_ - gate().p_EG);
  const Eigen::Vector2d n{-p0.y(), p0.x()};
  heading_doubt_ = ahrs_.heading_sigma() * ahrs_.heading_sigma();
  filter_.doubt(heading_doubt_ * n * n.transpose());
}

// ... and when it does, the difference tells δ: the update of the state the filter does not carry.
void Pilot::learn_heading_from_leg(const Fix& fix, const Eigen::Vector3d& moved) {
  const Eigen::Vector3d p0 = rotation_z(-gate().yaw_EG) * (anchor_E_ - gate().p_EG);
  const Eigen::Vector2d n{-p0.y(), p0.x()};
  if (n.norm() < kLongLeg) return;
  const Eigen::Vector2d difference = (fix.p_GB + moved - filter_.position()).head<2>();
  const Eigen::Matrix2d S = filter_.covariance().topLeftCorner<2, 2>() - heading_doubt_ * n * n.transpose() +
                            fix.covariance.topLeftCorner<2, 2>();
  if (!(S(0, 0) > 0.0) || !(S.determinant() > 0.0)) return;
  const Eigen::Vector2d w = S.inverse() * n;
  const double information = w.dot(n);
  correct_heading(-w.dot(difference) / information, 1.0 / information);
}

bool Pilot::correct_with(const GateDetection& seen) {
  Past then = past(capture_time(center(seen.corners_px).x()));
  auto fix = fix_of(seen, then);
  if (!fix) return false;
  const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
  const double limit = config_.filter.gate_sigma * config_.filter.gate_sigma;
  if (heading_doubt_ > 0.0 && filter_.distance2(*fix, moved) < limit) {
    learn_heading_from_leg(*fix, moved);
    then = past(then.time);
    fix = fix_of(seen, then);
    if (!fix) return false;
  }
  if (!fuse(*fix, moved, Sighting::Source::kCorners)) {
    // A gate where none is expected: either not this gate, or the estimate is wrong. Doubt grows.
    filter_.doubt(0.01 * Eigen::Matrix2d::Identity());
    return false;
  }
  if (fix->yaw_error) {
    const double gate_yaw = config_.gate_yaw_sigma;
    // Neighbouring pictures share their errors: each counts as a third.
    correct_heading(*fix->yaw_error, 3.0 * (fix->yaw_variance + gate_yaw * gate_yaw));
  }
  return true;
}

// How far from where it believes to be the drone would be, had it seen this gate; from before it or from behind.
double Pilot::surprise(const GateDetection& seen, const MapGate& gate, bool from_behind) const {
  const Past then = past(capture_time(center(seen.corners_px).x()));
  const double yaw = gate.yaw_EG + (from_behind ? kPi : 0.0);
  PoseParams anywhere = config_.pose;  // gates of other legs are seen from the side and from afar
  anywhere.max_lateral = anywhere.max_distance = 30.0;
  anywhere.max_misfit *= 4.0;
  const auto fix = fix_from_corners(seen.corners_px, {rotation_z(-yaw) * then.R_EB}, gate.side, config_.camera, anywhere);
  if (!fix) return 1e9;
  const Eigen::Vector3d p_E = gate.p_EG + rotation_z(yaw) * fix->p_GB + odometry_E_ - then.odometry_E;
  return (p_E - p_EB()).norm();
}

// The map says which gates there are: a sighting is of the one that surprises least.
bool Pilot::belongs_to_another_gate(const GateDetection& seen) const {
  constexpr double kKnown = 1.5;  // farther off it says nothing [m]
  const double expected = std::min(kKnown, surprise(seen, gate(), false));
  for (int i = 0; i < static_cast<int>(config_.track.gates.size()); ++i)
    for (const bool from_behind : {false, true})
      if ((i != target_ || from_behind) &&
          surprise(seen, config_.track.gates[static_cast<std::size_t>(i)], from_behind) < expected)
        return true;
  return false;
}

void Pilot::correct_with_lower_corners(const OpenGate& seen) {
  const Past then = past(capture_time(0.5 * (seen.bottom_left_px.x() + seen.bottom_right_px.x())));
  const auto fix = fix_from_lower_corners(seen, R_GB(then.R_EB), gate().side, config_.camera, pose_params());
  if (!fix) return;
  const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
  (void)fuse(*fix, moved, Sighting::Source::kCorners);
}

void Pilot::correct_with_bars(const GateBars& bars) {
  const Past then = past(capture_time(0.5 * (bars.left_px.x() + bars.right_px.x())));
  const auto fix = fix_from_bars(bars, R_GB(then.R_EB), gate().side - gate().bar, config_.camera, pose_params());
  if (!fix) return;
  const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
  (void)fuse(*fix, moved, Sighting::Source::kBars);
}

}  // namespace gatefly
