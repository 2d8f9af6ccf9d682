// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/map_lookout.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/race/seen_fix.hpp"

namespace gatefly {
namespace {

constexpr LookFor kPartToo{
    .gates = LookFor::Gates::kNone, .part = LookFor::Part::kToo, .again = true};

// Recorded pictures may come at 5 Hz only, and a gate is not found in each.
constexpr double kPause = 0.9;  // [s]
constexpr int kLeast = 6;

std::size_t filter_target(const Navigator& navigator) {
  const eskf::ErrorStateFilter& filter = *navigator.error_state();
  return filter.landmarks().in_slot(filter.target_slot());
}

}  // namespace

MapLookout::MapLookout(const LookoutParams& params)
    : params_{params},
      detector_{params.detector, params.detector_mode},
      attention_{params.sight},
      monitor_{{.pause = kPause, .least = kLeast}} {}

GateDetections MapLookout::whole_gates(const Sensors& sensors, const LookFor& look_for) {
  if (sensors.seen) return sensors.seen->gates;
  const GatesInView view = detector_.look(*sensors.image, params_.gate_color, look_for);
  sighting_.careful = sighting_.careful || view.careful;
  GateDetections whole;
  for (const GateDetection& gate : view.gates)
    if (gate.whole) (void)whole.push_back(gate);
  return whole;
}

void MapLookout::look(const Sensors& sensors, bool looking, const Course& course,
                      Navigator& navigator) {
  sighting_.seen = false;
  if (!sensors.image && !sensors.seen) return;
  const bool expected = sighting_.expected;  // by the last picture that was looked at
  sighting_ = {};
  sighting_.expected = expected;
  arrivals_.arrived(navigator.time() - sensors.picture_late);
  if (!sensors.seen && sensors.image->empty()) return;
  if (!looking || navigator.error_state() == nullptr) return;
  monitor_.looked(navigator.time());
  if (course.passed() != passed_) passed_ = course.passed(), target_seen_ = false;
  const Eigen::Vector2d size =
      sensors.seen ? Eigen::Vector2d{sensors.seen->image_width, sensors.seen->image_height}
                   : Eigen::Vector2d{sensors.image->width(), sensors.image->height()};
  CameraTiming timing = params_.timing;
  timing.latency += sensors.picture_late;
  // The configuration keeps pictures that come in time within the memory; a late one may be older, and
  // is then no evidence that the place is wrong.
  if (sensors.picture_late > 0.0 &&
      !navigator.error_state()->remembers(navigator.time() - timing.latency))
    return;
  const View view{
      sensors,
      course,
      navigator,
      {params_.camera, timing, navigator.time(), size, arrivals_.sigma(), arrivals_.interval()}};
  size_px_ = size;
  const double ago = timing.latency - navigator.error_state()->now().delay;
  const Attention::Known known{.since_any = navigator.time() - last_any_,
                               .since_target = navigator.since_fix(),
                               .waits = std::exchange(pending_.waits, false)};
  sighting_.detections = whole_gates(
      sensors, sensors.seen ? LookFor{}
                            : attention_.next(*navigator.error_state(), known, ago, view.picture));
  sighting_.seen = !sighting_.detections.empty();
  sighting_.expected = target_should_show(view, ago);
  take_whole_gates(view);
  const double x = navigator.error_state()->p_GB().x();
  const double from = params_.sight.parts_from * course.gate().side;
  const bool near_target = x > -from && x < 0.0;
  if (sighting_.source == Sighting::Source::kNone && near_target) take_parts(view);
}

bool MapLookout::target_should_show(const View& view, double ago) const {
  constexpr double kWellSeen = 24.0, kFacing = 0.7;  // [px], [estimate]
  const eskf::ErrorStateFilter& filter = *view.navigator.error_state();
  const auto target = expected_gate(filter, filter.target_slot(), ago, view.picture);
  const auto shows = [&](const Eigen::Vector2d& px) {
    return (px.array() >= 0.0).all() && (px.array() <= view.picture.size_px.array() - 1.0).all();
  };
  return target && target->side_px > kWellSeen && target->facing > kFacing &&
         std::all_of(target->bars_px.begin(), target->bars_px.end(), shows);
}

bool MapLookout::would_show_whole(const MapGate& gate, const Eigen::Vector3d& p_GB) const {
  const auto shows = [&](const Eigen::Vector3d& corner_G) {
    const Eigen::Vector3d p_C =
        params_.camera.R_BC.matrix.transpose() * (corner_G - p_GB - params_.camera.p_BC);
    const auto px = p_C.z() > 0.0 ? params_.camera.lens.project(p_C) : std::nullopt;
    return px && (px->array() >= 0.0).all() && (px->array() <= size_px_.array() - 1.0).all();
  };
  if (size_px_.isZero()) return true;  // no picture has come: nothing says that it would not
  const auto corners = gate_corners_G(gate.side);
  return std::all_of(corners.begin(), corners.end(), shows);
}

bool MapLookout::is_target(const eskf::GateSight& sight, const View& view) const {
  const eskf::ErrorStateFilter& filter = *view.navigator.error_state();
  return sight.slot == filter.target_slot() && sight.behind == filter.target_behind();
}

// After a blind leg, and where it is improbable, a second one has to agree.
bool MapLookout::believed(const Associated& seen, const GateDetection& gate, bool target,
                          bool blind) {
  const double nis = seen.innovation.nis;
  if (seen.margin < map_.margin) return false;
  // Corners a pixel off are a third of a metre where the gate stands far behind the next one.
  const double unsure_nis = target || blind ? map_.unsure_nis : 0.0;
  if (gate.fitness < params_.sight.sure && nis > unsure_nis) return false;
  return (!blind && nis < map_.confirm_above) || seen_again(seen.sight);
}

// Whether a picture shortly before showed the same gate from the same side.
bool MapLookout::seen_again(const eskf::GateSight& sight) {
  const int face = eskf::face_of(sight);
  const double since = sight.time - pending_.time;
  const bool again = pending_.face == face && since > 0.01 && since < map_.confirm_within;
  pending_ = {.face = face, .time = sight.time, .waits = !again};
  return again;
}

void MapLookout::take_whole_gates(const View& view) {
  Navigator& navigator = view.navigator;
  const bool blind = navigator.time() - last_any_ > map_.blind_after;
  FixedList<eskf::GateSight, GateDetections::kCapacity> taken;
  bool of_target = false;
  for (std::size_t i = 0; i < sighting_.detections.size(); ++i) {
    const GateDetection& gate = sighting_.detections[i];
    const auto sight = sight_of(gate.corners_px, view.picture);
    if (!sight) continue;
    const auto seen = associate(*navigator.error_state(), *sight, map_.max_nis);
    if (!seen) {
      if (gate.fitness > params_.sight.sure) ++refused_, monitor_.refused(navigator.time());
      if (gate.fitness > StrayParams{}.least_fitness) note_stray(gate, view);
      continue;
    }
    const bool target = is_target(seen->sight, view);
    sighting_.offered = sighting_.offered || target;
    if (target) stray_.target_seen(filter_target(navigator));
    if (!believed(*seen, gate, target, blind)) continue;
    (void)taken.push_back(seen->sight);
    monitor_.taken(seen->innovation.nis, seen->innovation.rows, navigator.time());
    if (!target) continue;
    of_target = true;
    sighting_.used = static_cast<int>(i);
    sighting_.nis = seen->innovation.nis, sighting_.nis_dof = seen->innovation.rows;
  }
  if (!taken.empty() && navigator.correct({taken.begin(), taken.size()}, of_target)) {
    last_any_ = navigator.time(), refused_ = 0;
    sighting_.tells_height = true;
    if (!of_target) return;
    target_seen_ = true;
    sighting_.source = Sighting::Source::kCorners;
    describe_fix(sighting_.detections[static_cast<std::size_t>(sighting_.used)], view);
  } else if (refused_ >= map_.lost_after && navigator.time() - last_any_ > map_.lost_time) {
    // Gates at one place again and again, by a drone that knows where it is: they may be what is off.
    if (!stray_.is_followed(navigator.time())) navigator.doubt();
    refused_ = 0;
  }
}

// A gate where the map has none, again and again, while the one flown to does not show where it should:
// it is that one.
void MapLookout::note_stray(const GateDetection& gate, const View& view) {
  constexpr double kSigma = 0.3, kYawSigma = 0.2;  // [m] [rad]
  Navigator& navigator = view.navigator;
  const eskf::ErrorStateFilter& filter = *navigator.error_state();
  const std::size_t target = filter_target(navigator);
  if (stray_.was_recognised(target) || !stray_.expects_target(filter, params_.camera.p_BC)) return;
  const double ago = view.picture.timing.latency - filter.now().delay;
  const auto place =
      place_of(gate.corners_px, view.course.gate().side, filter, ago, params_.camera, params_.pose);
  if (!place) return;
  // A heading that is off puts a gate aside by as much as it is far.
  const double own = std::max(filter.sigma(eskf::kP), filter.sigma(eskf::kP + 1)),
               aside = (place->p_EG - filter.now().p_EB).head<2>().norm() *
                       filter.sigma(eskf::kTheta + 2),
               sigma = std::sqrt(own * own + aside * aside);
  if (is_another_gate(place->p_EG, sigma, filter.landmarks(), target)) return;
  stray_.seen(*place, sigma, navigator.time());
  const auto instead = stray_.instead_of(navigator.gate());
  if (!instead) return;
  navigator.replace_target(*instead, kSigma, kYawSigma);
  stray_.target_seen(target);
}

// Near the target two corners of any gate are enough, or the target's side bars. These do not say whose
// they are: they count where the target's corners were seen in this approach.
void MapLookout::take_parts(const View& view) {
  std::optional<GateBars> bars;
  std::optional<GateDetection> cut;
  Openings openings;
  if (view.sensors.seen) {
    sighting_.lower_corners = view.sensors.seen->lower_corners, bars = view.sensors.seen->bars;
    cut = view.sensors.seen->cut;
  } else {
    const GatesInView seen = detector_.look(*view.sensors.image, params_.gate_color, kPartToo);
    openings = seen.openings;
    if (seen.part)
      sighting_.lower_corners = seen.part->lower_corners(), bars = seen.part->bars,
      cut = seen.part->gate;
  }
  // All four corners of an opening say more than two of a gate.
  for (const GateDetection& opening : openings)
    if (const auto sight = sight_of_cut(opening, view.picture)) take_cut(view, *sight);
  if (sighting_.source != Sighting::Source::kNone) return;
  // Corners say whose they are, bars do not: where corners fit no gate their bars count no more.
  if (const auto sight = cut ? sight_of_cut(*cut, view.picture) : std::nullopt) {
    take_cut(view, *sight);
    return;
  }
  if (sighting_.lower_corners && take_part(view, sight_of(*sighting_.lower_corners, view.picture),
                                           map_.max_lower_nis, Sighting::Source::kCorners))
    return;
  sighting_.bars = bars;
  if (bars && target_seen_)
    (void)take_part(view, sight_of(*bars, view.picture), map_.max_bars_nis,
                    Sighting::Source::kBars);
}

// Two corners are those of any gate: of the one that explains them far better than all others, and
// again in the next picture where little is known of the place.
void MapLookout::take_cut(const View& view, const eskf::GateSight& sight) {
  const eskf::ErrorStateFilter& filter = *view.navigator.error_state();
  const std::size_t corners = sight.features.size();
  const double max_nis = corners > 3   ? map_.max_nis
                         : corners > 2 ? map_.max_three_nis
                                       : map_.max_lower_nis;
  const auto seen = associate(filter, sight, max_nis);
  const bool is_opening = sight.features[0].kind == eskf::Feature::Kind::kOpening;
  // As sure as a whole gate: where it fits none, the position may be what is off.
  if (!seen && is_opening && corners > 3) ++refused_, monitor_.refused(view.navigator.time());
  if (!seen || seen->margin < map_.margin) return;
  const bool target = is_target(seen->sight, view);
  sighting_.offered = sighting_.offered || target;
  const double place_sigma = std::max(filter.sigma(eskf::kP), filter.sigma(eskf::kP + 1));
  const bool blind = is_opening && view.navigator.time() - last_any_ > map_.blind_after;
  const bool sure = !blind && place_sigma < map_.part_sigma && seen->innovation.nis < 0.7 * max_nis;
  // Two corners of an opening alone fit a gate near by and one farther away.
  if (!sure && ((is_opening && corners < 3) || !seen_again(seen->sight))) return;
  if (!view.navigator.correct({&seen->sight, 1}, target)) return;
  last_any_ = view.navigator.time(), refused_ = 0;
  sighting_.tells_height = true;
  if (!target) return;
  target_seen_ = true;
  sighting_.source = Sighting::Source::kCorners;
  sighting_.nis = seen->innovation.nis, sighting_.nis_dof = seen->innovation.rows;
}

bool MapLookout::take_part(const View& view, std::optional<eskf::GateSight> sight, double max_nis,
                           Sighting::Source source) {
  if (!sight) return false;
  const eskf::ErrorStateFilter& filter = *view.navigator.error_state();
  if (std::max(filter.sigma(eskf::kP), filter.sigma(eskf::kP + 1)) > map_.part_sigma) return false;
  sight->slot = filter.target_slot(), sight->behind = filter.target_behind();
  const auto innovation = filter.innovation_of(*sight);
  sighting_.offered = true;
  if (!innovation || !(innovation->nis < max_nis)) return false;
  if (!view.navigator.correct({&*sight, 1}, true)) return false;
  last_any_ = view.navigator.time(), refused_ = 0;
  sighting_.source = source;
  sighting_.tells_height = sighting_.tells_height || source == Sighting::Source::kCorners;
  sighting_.nis = innovation->nis, sighting_.nis_dof = innovation->rows;
  return true;
}

// The position by this picture alone, without the filter: for other filters and for logs.
void MapLookout::describe_fix(const GateDetection& gate, const View& view) {
  const eskf::ErrorStateFilter& filter = *view.navigator.error_state();
  const eskf::Nominal& x = filter.now();
  const double ago = view.picture.timing.latency - x.delay;
  const Eigen::Matrix3d R_GE = rotation_z(-filter.target_yaw());
  PoseParams pose = params_.pose;
  const double tilt = view.navigator.tilt_sigma(), map_yaw = params_.gate_yaw_sigma;
  pose.attitude_sigma = std::sqrt(pose.attitude_sigma * pose.attitude_sigma + tilt * tilt);
  CameraRig rig = params_.camera;
  rig.R_BC.matrix = x.R_BC;
  const auto fix =
      map_fix_from_corners(gate.corners_px, {R_GE * x.R_EB * rotation_of(-ago * x.rate_B)},
                           view.course.gate().side, rig, pose);
  if (!fix) return;
  const MapGate& map = view.course.gate();
  const Eigen::Matrix3d R_EG = rotation_z(map.yaw_EG);
  FixOnCourse& used = sighting_.fix.emplace();
  used.p_EB = map.p_EG + R_EG * (fix->p_GB + ago * (R_GE * x.v_E));
  used.covariance = R_EG * fix->covariance * R_EG.transpose();
  if (fix->yaw_error) used.yaw = wrap_angle(view.navigator.state().attitude.yaw + *fix->yaw_error);
  used.yaw_sigma = std::sqrt(fix->yaw_variance + map_yaw * map_yaw);
}

}  // namespace gatefly
