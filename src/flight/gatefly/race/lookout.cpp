// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/lookout.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/seen_fix.hpp"

namespace gatefly {
namespace {

double hypotenuse(double a, double b) { return std::sqrt(a * a + b * b); }

constexpr double kNever = 1e9;  // [m]
constexpr LookFor kPartToo{
    .gates = LookFor::Gates::kNone, .part = LookFor::Part::kToo, .again = true};

}  // namespace

Lookout::Lookout(const LookoutParams& params)
    : params_{params}, detector_{params.detector, params.detector_mode} {}

GateDetections Lookout::whole_gates(const Sensors& sensors, const LookFor& look_for) {
  if (sensors.seen) return sensors.seen->gates;
  const GatesInView view = detector_.look(*sensors.image, params_.gate_color, look_for);
  sighting_.careful = sighting_.careful || view.careful;
  GateDetections whole;
  for (const GateDetection& gate : view.gates)
    if (gate.whole) (void)whole.push_back(gate);
  return whole;
}

void Lookout::look(const Sensors& sensors, bool looking, const Course& course,
                   Navigator& navigator) {
  sighting_.seen = false;
  if (!sensors.image && !sensors.seen) return;
  sighting_ = {};
  if (!sensors.seen && sensors.image->empty()) return;
  image_width_ = sensors.seen ? sensors.seen->image_width : sensors.image->width();
  if (!looking) return;
  const View view{sensors, course, navigator};
  const Expectation expected = sensors.seen ? Expectation{} : expectation(view);
  sighting_.detections = whole_gates(sensors, sensors.seen ? LookFor{} : look_for(expected, view));
  sighting_.seen = !sighting_.detections.empty();

  auto best = best_whole_gate(view);
  const bool was_quick =
      sighting_.seen && sighting_.detections[0].method == DetectionMethod::kSnake && !sensors.seen;
  if (!convincing(best) && was_quick) {
    // Another gate stood out; the one that is looked for may be there, too.
    sighting_.detections = whole_gates(sensors, {.gates = LookFor::Gates::kAll, .again = true});
    best = best_whole_gate(view);
  }
  const double x = navigator.filter().position().x();
  if (!convincing(best) && x > -params_.sight.parts_from && x < 0.0) {
    // Near the gate parts of it are enough. A frame may be put together from bars of two gates: the
    // more probable counts.
    const auto part = best_part(view);
    if (part && (!best || part->nis < best->nis)) best = part;
  }
  if (best) correct_with(*best, view);
}

Lookout::Expectation Lookout::expectation(const View& view) const {
  constexpr double kNearest = 0.4;  // before the lens [m]
  const Navigator& navigator = view.navigator;
  if (!navigator.has_fix() || navigator.since_fix() > params_.sight.expect_for) return {};
  const Past* then = past_of(0.5 * image_width_, view);
  if (then == nullptr) return {};
  const MapGate& gate = view.course.gate();
  Quad bars;
  bool in_view = false;
  const auto corners = gate_corners_G(gate.side - gate.bar);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d p_B =
        R_GB_of(*then).matrix.transpose() * (corners[i] - then->filter.position());
    const Eigen::Vector3d p_C =
        params_.camera.R_BC.matrix.transpose() * (p_B - params_.camera.p_BC);
    const auto px = p_C.z() > kNearest ? params_.camera.lens.project(p_C) : std::nullopt;
    if (!px) return {.known = true, .bars = {}};
    bars[i] = *px;
    in_view = in_view || is_in_picture(*px, view);
  }
  if (!in_view) return {.known = true, .bars = {}};
  return {.known = true, .bars = bars};
}

bool Lookout::is_in_picture(const Eigen::Vector2d& px, const View& view) const {
  const Image& image = *view.sensors.image;
  return px.x() >= 0.0 && px.y() >= 0.0 && px.x() <= image.width() - 1.0 &&
         px.y() <= image.height() - 1.0;
}

// Looking carefully costs a hundred times as much. It is for gates that are expected, not found, and
// sometimes in case the estimate is wrong.
LookFor Lookout::look_for(const Expectation& expected, const View& view) {
  LookFor look{.gates = LookFor::Gates::kStandingOut};
  if (expected.bars) look.expected_bars = &*expected.bars;
  const bool is_lost = !expected.known ||
                       (expected.bars && view.navigator.since_fix() > params_.sight.careful_after);
  look.quick = !is_lost && ++quick_looks_ < params_.sight.careful_every;
  if (!look.quick) quick_looks_ = 0;
  return look;
}

bool Lookout::convincing(const std::optional<Candidate>& candidate) const {
  return candidate && candidate->nis < params_.sight.convincing;
}

// The moment at which a column of the picture was exposed.
const Navigator::Past* Lookout::past_of(double u_px, const View& view) const {
  const double across = std::clamp(u_px / image_width_ - 0.5, -0.5, 0.5);
  const double age = params_.timing.latency + view.sensors.picture_late;
  return view.navigator.at(view.navigator.time() - age + across * params_.timing.readout);
}

// The frame that fits best to where the gate should be.
std::optional<Lookout::Candidate> Lookout::best_whole_gate(const View& view) const {
  std::optional<Candidate> best;
  for (std::size_t i = 0; i < sighting_.detections.size(); ++i) {
    const GateDetection& seen = sighting_.detections[i];
    const Past* then = past_of(center(seen.corners_px).x(), view);
    const auto fix = then ? fix_of(seen, *then, view) : std::nullopt;
    if (!fix) continue;
    const double here = distance_from(seen, *then, view.course.gate(), false, view);
    const double elsewhere = distance_from_others(seen, *then, view);
    if (elsewhere < std::min(params_.sight.tell_apart, here)) continue;
    auto one = candidate(*fix, *then, Sighting::Source::kCorners, view, static_cast<int>(i));
    if (seen.fitness < params_.sight.sure && !convincing(one)) continue;
    one.may_restart = here <= elsewhere && fix->p_GB.norm() < params_.sight.restart_within;
    if (!best || one.nis < best->nis) best = one;
  }
  return best;
}

// The lower corners, or the side bars.
std::optional<Lookout::Candidate> Lookout::best_part(const View& view) {
  std::optional<GateBars> bars;
  if (view.sensors.seen) {
    sighting_.lower_corners = view.sensors.seen->lower_corners, bars = view.sensors.seen->bars;
  } else if (const auto part =
                 detector_.look(*view.sensors.image, params_.gate_color, kPartToo).part) {
    sighting_.lower_corners = part->lower_corners(), bars = part->bars;
  }
  const MapGate& gate = view.course.gate();
  std::optional<Candidate> corners;
  if (sighting_.lower_corners) {
    const LowerCorners& lower = *sighting_.lower_corners;
    const Past* then = past_of(0.5 * (lower.bottom_left_px.x() + lower.bottom_right_px.x()), view);
    const auto fix = then ? fix_from_lower_corners(lower, R_GB_of(*then), gate.side, params_.camera,
                                                   pose_params(view.navigator))
                          : std::nullopt;
    if (fix) corners = candidate(*fix, *then, Sighting::Source::kCorners, view);
  }
  const double limit = params_.gate_sigma * params_.gate_sigma;
  const double x = view.navigator.filter().position().x();
  if ((corners && corners->nis < limit) || x < -params_.pose.max_bars_distance) return corners;
  sighting_.bars = bars;
  if (!bars) return corners;
  const Past* then = past_of(0.5 * (bars->left_px.x() + bars->right_px.x()), view);
  const auto fix = then ? fix_from_bars(*bars, R_GB_of(*then), gate.side - gate.bar, params_.camera,
                                        pose_params(view.navigator))
                        : std::nullopt;
  return fix ? candidate(*fix, *then, Sighting::Source::kBars, view) : corners;
}

Lookout::Candidate Lookout::candidate(const Fix& fix, const Past& then, Sighting::Source source,
                                      const View& view, int detection) const {
  return {fix, &then, then.filter.nis(view.navigator.as_fused(fix)), source, detection};
}

std::optional<Fix> Lookout::fix_of(const GateDetection& seen, const Past& then,
                                   const View& view) const {
  return map_fix_from_corners(seen.corners_px, R_GB_of(then), view.course.gate().side,
                              params_.camera, pose_params(view.navigator));
}

PoseParams Lookout::pose_params(const Navigator& navigator) const {
  PoseParams params = params_.pose;
  params.attitude_sigma = hypotenuse(params_.pose.attitude_sigma, navigator.ahrs().tilt_sigma());
  params.gate_yaw_sigma = params_.gate_yaw_sigma;
  params.heading_sigma = hypotenuse(navigator.ahrs().heading_sigma(), params_.gate_yaw_sigma);
  return params;
}

// After a blind leg the innovation gate is wide, and one wrong gate would turn the heading; where the
// covariance is large, a gate a metre off is within it, and would get far too much weight. Two
// sightings have to agree.
bool Lookout::is_confirmed(const Candidate& seen, const View& view) {
  const Confirmation now{seen.then->time, view.course.passed(),
                         seen.fix.p_GB - seen.then->odometry};
  const auto before = std::exchange(pending_, now);
  return before && before->passed == now.passed &&
         now.time - before->time < params_.sight.blind_after &&
         (now.start - before->start).norm() < params_.sight.agree;
}

void Lookout::correct_with(Candidate seen, const View& view) {
  const bool whole = seen.detection >= 0;
  const bool was_blind =
      view.navigator.has_fix() && view.navigator.since_fix() > params_.sight.blind_after;
  const bool within = seen.nis < params_.gate_sigma * params_.gate_sigma;
  const bool improbable = seen.nis > params_.sight.confirm_above;
  if (whole && (was_blind || improbable) && within && !is_confirmed(seen, view)) return;
  if (whole && was_blind && within) {
    view.navigator.learn_heading(seen.fix, *seen.then);
    const auto i = static_cast<std::size_t>(seen.detection);
    const auto again = fix_of(sighting_.detections[i], *seen.then, view);
    if (!again) return;
    seen.fix = *again;
  }
  if (!fuse({seen.fix, seen.then, seen.source, seen.may_restart}, view.course.gate(),
            params_.gate_yaw_sigma, view.navigator, sighting_))
    return;
  sighting_.used = seen.detection;
  if (!seen.fix.yaw_error) return;
  const double gate_yaw = params_.gate_yaw_sigma;
  const double variance =
      params_.sight.heading_repeats * (seen.fix.yaw_variance + gate_yaw * gate_yaw);
  view.navigator.correct_heading(*seen.fix.yaw_error, variance);
}

// Distance between the estimated position and that from which the detection would be this gate, seen
// from before it or from behind [m].
double Lookout::distance_from(const GateDetection& seen, const Past& then, const MapGate& gate,
                              bool from_behind, const View& view) const {
  // Gates of other legs are seen from the side and from afar.
  constexpr double kAnywhere = 30.0, kLooser = 4.0;
  const MapGate& target = view.course.gate();
  const double yaw = gate.yaw_EG + (from_behind ? kPi : 0.0);
  PoseParams anywhere = params_.pose;
  anywhere.max_lateral = anywhere.max_distance = kAnywhere;
  anywhere.max_misfit *= kLooser;
  const auto fix =
      fix_from_corners(seen.corners_px, {rotation_z(target.yaw_EG - yaw) * R_GB_of(then).matrix},
                       gate.side, params_.camera, anywhere);
  if (!fix) return kNever;
  const Eigen::Vector3d believed = target.p_EG + rotation_z(target.yaw_EG) * then.filter.position();
  return (gate.p_EG + rotation_z(yaw) * fix->p_GB - believed).norm();
}

// The map says which gates there are: a sighting is of the one it is nearest to.
double Lookout::distance_from_others(const GateDetection& seen, const Past& then,
                                     const View& view) const {
  double least = kNever;
  const auto& gates = view.course.track().gates;
  for (int i = 0; i < static_cast<int>(gates.size()); ++i)
    for (const bool from_behind : {false, true})
      if (i != view.course.target() || from_behind)
        least = std::min(least, distance_from(seen, then, gates[static_cast<std::size_t>(i)],
                                              from_behind, view));
  return least;
}

}  // namespace gatefly
