// SPDX-License-Identifier: Apache-2.0
// The pilot's eye: from a picture to corrections of position and heading.
#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly {
namespace {

constexpr double kBlind = 1.0;         // without a fix for this long, a leg was flown blind [s]
constexpr double kOpenGateFrom = 4.5;  // nearer than this the upper bar may be cut off [m]
constexpr double kAgree = 0.4;         // two sightings, 66 ms apart, from one place [m]
// squared distance: one in twenty of the right fixes is farther off
constexpr double kSurprising = 7.8;
// what farther gates err by lasts for a second and agrees with itself, too [m]
constexpr double kNear = 7.0;
// how far off the estimate may be and still tell gates apart [m]
constexpr double kKnown = 1.5;
// of a detection; what is less sure counts where a gate is expected
constexpr double kSure = 0.9;
constexpr LookFor kPartOnly{.gates = LookFor::Gates::kNone, .part = LookFor::Part::kToo};
constexpr double kLongLeg = 2.5;  // shorter ones say nothing about heading [m]

// Attitude against the gate's frame at that moment.
RotationGB R_GB_of(const DelayedFilter::Moment& then) {
  return {rotation_EB(Attitude{then.input.roll, then.input.pitch, then.input.yaw}).matrix};
}

}  // namespace

GateDetections Pilot::whole_gates(const Sensors& sensors, Effort effort) {
  if (sensors.seen) return sensors.seen->gates;
  const auto wanted = effort == Effort::kAll ? LookFor::Gates::kAll : LookFor::Gates::kStandingOut;
  GateDetections whole;
  for (const GateDetection& gate :
       detector_.look(*sensors.image, config_.gate_color, {.gates = wanted}).gates)
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

  auto best = best_whole_gate();
  const bool was_quick =
      sighting_.seen && sighting_.detections[0].method == DetectionMethod::kSnake && !sensors.seen;
  if (!convincing(best) && was_quick) {
    // Another gate stood out; the one that is looked for may be there, too.
    sighting_.detections = whole_gates(sensors, Effort::kAll);
    best = best_whole_gate();
  }
  const double x = filter().position().x();
  if (!convincing(best) && x > -kOpenGateFrom && x < 0.0) {
    // Near the gate parts of it are enough. A frame may be put together from bars of two gates:
    // what surprises less counts.
    const auto part = best_part(sensors);
    if (part && (!best || part->distance2 < best->distance2)) best = part;
  }
  if (best) (void)correct_with(*best);
}

bool Pilot::convincing(const std::optional<Candidate>& candidate) const {
  // squared distance: one in four of the right ones is farther off
  constexpr double kConvincing = 4.1;
  return candidate && candidate->distance2 < kConvincing;
}

// The frame that fits best to where the gate should be.
std::optional<Pilot::Candidate> Pilot::best_whole_gate() const {
  std::optional<Candidate> best;
  for (std::size_t i = 0; i < sighting_.detections.size(); ++i) {
    const GateDetection& seen = sighting_.detections[i];
    const Past* then = memory_.at(capture_time(center(seen.corners_px).x()));
    const auto fix = then ? fix_of(seen, *then) : std::nullopt;
    if (!fix) continue;
    const double here = surprise(seen, *then, gate(), false),
                 elsewhere = surprise_of_others(seen, *then);
    if (elsewhere < std::min(kKnown, here)) continue;
    auto one = candidate(*fix, *then, Sighting::Source::kCorners, static_cast<int>(i));
    if (seen.fitness < kSure && !convincing(one)) continue;
    one.may_restart = here <= elsewhere && fix->p_GB.norm() < kNear;
    if (!best || one.distance2 < best->distance2) best = one;
  }
  return best;
}

// The lower corners, or the side bars.
std::optional<Pilot::Candidate> Pilot::best_part(const Sensors& sensors) {
  std::optional<GateBars> bars;
  if (sensors.seen) {
    sighting_.open = sensors.seen->open, bars = sensors.seen->bars;
  } else if (const auto part = detector_.look(*sensors.image, config_.gate_color, kPartOnly).part) {
    sighting_.open = part->lower_corners(), bars = part->bars;
  }
  std::optional<Candidate> corners;
  if (sighting_.open) {
    const Past* then = memory_.at(capture_time(
        0.5 * (sighting_.open->bottom_left_px.x() + sighting_.open->bottom_right_px.x())));
    const auto fix = then ? fix_from_lower_corners(*sighting_.open, R_GB_of(*then), gate().side,
                                                   config_.camera, pose_params())
                          : std::nullopt;
    if (fix) corners = candidate(*fix, *then, Sighting::Source::kCorners);
  }
  const double limit = config_.filter.gate_sigma * config_.filter.gate_sigma;
  if ((corners && corners->distance2 < limit) ||
      filter().position().x() < -config_.pose.max_bars_distance)
    return corners;
  sighting_.bars = bars;
  if (!bars) return corners;
  const Past* then = memory_.at(capture_time(0.5 * (bars->left_px.x() + bars->right_px.x())));
  const auto fix = then ? fix_from_bars(*bars, R_GB_of(*then), gate().side - gate().bar,
                                        config_.camera, pose_params())
                        : std::nullopt;
  return fix ? candidate(*fix, *then, Sighting::Source::kBars) : corners;
}

Pilot::Candidate Pilot::candidate(const Fix& fix, const Past& then, Sighting::Source source,
                                  int detection) const {
  return {fix, &then, then.filter.distance2(fix), source, detection};
}

bool Pilot::fuse(const Candidate& seen) {
  const Fix& fix = seen.fix;
  const double innovation2 = seen.then->filter.distance2(fix);
  const Eigen::Vector3d moved = filter().position() - seen.then->filter.position();
  sighting_.offered = true;
  const Fusion fusion = memory_.correct(fix, seen.then->time, seen.may_restart);
  if (fusion != Fusion::kAccepted && fusion != Fusion::kRestarted) return false;
  const Eigen::Matrix3d R_EG = rotation_z(gate().yaw_EG);
  FixOnCourse& used = sighting_.fix.emplace();
  used.p_EB = gate().p_EG + R_EG * (fix.p_GB + moved);
  used.covariance = R_EG * fix.covariance * R_EG.transpose();
  used.has_height = fix.has_height;
  if (fix.yaw_error) used.yaw = wrap_angle(ahrs_.attitude().yaw + *fix.yaw_error);
  used.yaw_sigma = std::sqrt(fix.yaw_variance + config_.gate_yaw_sigma * config_.gate_yaw_sigma);
  if (fusion == Fusion::kAccepted)
    sighting_.innovation2 = innovation2, sighting_.innovation_dof = fix.has_height ? 3 : 2;
  last_fix_ = time_;
  sighting_.source = seen.source;
  return true;
}

std::optional<Fix> Pilot::fix_of(const GateDetection& seen, const Past& then) const {
  return map_fix_from_corners(seen.corners_px, R_GB_of(then), gate().side, config_.camera,
                              pose_params());
}

PoseParams Pilot::pose_params() const {
  PoseParams params = config_.pose;
  params.attitude_sigma = std::hypot(config_.pose.attitude_sigma, ahrs_.tilt_sigma());
  params.gate_yaw_sigma = config_.gate_yaw_sigma;
  params.heading_sigma = std::hypot(ahrs_.heading_sigma(), config_.gate_yaw_sigma);
  return params;
}

void Pilot::correct_heading(double error, double variance) {
  const double before = ahrs_.attitude().yaw;
  ahrs_.correct_heading(error, variance);
  memory_.turn_past(wrap_angle(ahrs_.attitude().yaw - before));
}

// A leg flown blind on a heading that is off by δ ends δ ẑ × p₀ beside where it should, p₀ being
// where it began, seen from the next gate. The filter's doubt knows that; the difference to the
// first fix tells δ.
void Pilot::learn_heading_from_leg(const Candidate& seen) {
  const DragFilter& filter = seen.then->filter;
  const double sigma = ahrs_.heading_sigma();
  const Eigen::Vector2d n = filter.heading_lever(seen.fix) / sigma;
  if (n.norm() < kLongLeg) return;
  const Eigen::Vector2d difference = (seen.fix.p_GB - filter.position()).head<2>();
  const Eigen::Matrix2d S = filter.innovation_covariance(seen.fix).topLeftCorner<2, 2>() -
                            sigma * sigma * n * n.transpose();
  if (!(S(0, 0) > 0.0) || !(S.determinant() > 0.0)) return;
  const Eigen::Vector2d w = S.inverse() * n;
  const double information = w.dot(n);
  correct_heading(-w.dot(difference) / information, 1.0 / information);
}

// After a blind leg much is believed, and one wrong gate would turn the heading; where doubt is
// large, a gate a metre off is within it, and would be believed far too well. There have to be two
// that agree.
bool Pilot::is_second_witness(const Candidate& seen) {
  const Witness now{seen.then->time, seen.fix.p_GB - seen.then->odometry};
  const auto before = std::exchange(witness_, now);
  return before && now.time - before->time < kBlind && (now.start - before->start).norm() < kAgree;
}

bool Pilot::correct_with(Candidate seen) {
  const bool whole = seen.detection >= 0,
             was_blind = last_fix_ >= 0.0 && time_ - last_fix_ > kBlind;
  const double limit = config_.filter.gate_sigma * config_.filter.gate_sigma;
  if (whole && (was_blind || seen.distance2 > kSurprising) && seen.distance2 < limit &&
      !is_second_witness(seen))
    return false;
  if (whole && was_blind && seen.distance2 < limit) {
    learn_heading_from_leg(seen);
    const auto again =
        fix_of(sighting_.detections[static_cast<std::size_t>(seen.detection)], *seen.then);
    if (!again) return false;
    seen.fix = *again;
  }
  if (!fuse(seen)) return false;
  sighting_.used = seen.detection;
  if (seen.fix.yaw_error) {
    const double gate_yaw = config_.gate_yaw_sigma;
    // Neighbouring pictures share their errors: each counts as a third.
    correct_heading(*seen.fix.yaw_error, 3.0 * (seen.fix.yaw_variance + gate_yaw * gate_yaw));
  }
  return true;
}

// How far from where it believes to be the drone would be, had it seen this gate; from before it or
// from behind.
double Pilot::surprise(const GateDetection& seen, const Past& then, const MapGate& gate,
                       bool from_behind) const {
  const double yaw = gate.yaw_EG + (from_behind ? kPi : 0.0);
  PoseParams anywhere = config_.pose;  // gates of other legs are seen from the side and from afar
  anywhere.max_lateral = anywhere.max_distance = 30.0;
  anywhere.max_misfit *= 4.0;
  const auto fix = fix_from_corners(seen.corners_px,
                                    {rotation_z(this->gate().yaw_EG - yaw) * R_GB_of(then).matrix},
                                    gate.side, config_.camera, anywhere);
  if (!fix) return 1e9;
  const Eigen::Vector3d believed =
      this->gate().p_EG + rotation_z(this->gate().yaw_EG) * then.filter.position();
  return (gate.p_EG + rotation_z(yaw) * fix->p_GB - believed).norm();
}

// The map says which gates there are: a sighting is of the one that surprises least.
double Pilot::surprise_of_others(const GateDetection& seen, const Past& then) const {
  double least = 1e9;
  for (int i = 0; i < static_cast<int>(config_.track.gates.size()); ++i)
    for (const bool from_behind : {false, true})
      if (i != target_ || from_behind)
        least = std::min(
            least,
            surprise(seen, then, config_.track.gates[static_cast<std::size_t>(i)], from_behind));
  return least;
}

}  // namespace gatefly
