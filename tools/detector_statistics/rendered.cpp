// SPDX-License-Identifier: Apache-2.0
#include "rendered.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>

#include "gatefly/race/part_params.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/sim/lookalikes.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/solids.hpp"
#include "gatefly/simulated_race/race_maker.hpp"

#include "eyes.hpp"

namespace gatefly::measuring {
namespace {

constexpr double kPartsFrom = 4.5;   // SightParams::parts_from: nearer than this parts count [m]
constexpr double kLowerReach = 3.3;  // [m]
constexpr double kBarsReach = 1.7;   // [m]
constexpr double kSameParts = 20.0;  // [px]
constexpr double kSameCut = 0.1;     // ... or this much of the side
constexpr double kOfGate = 0.15;     // shares this much with a gate: it is a crooked frame of it
constexpr double kAgain = 0.07;      // from here to there it is the same place [rad]

/// A picture that a race would take.
struct Moment {
  double start = 0.0;  ///< Of the exposure [s].
  int target = 0;      ///< Index of the gate that is flown to.
};

struct Flown {
  std::vector<sim::BodyPose> poses;
  std::vector<Moment> moments;
};

Flown flown(simulated_race::RaceConfig race) {
  constexpr double kFlying = 0.5;  // on the pad there is nothing to see [m]
  race.vision = simulated_race::Vision::kIdeal;
  Flown flight;
  (void)simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    const double t = 1e-9 * static_cast<double>(tick.sensors.time.count());
    flight.poses.push_back({t, tick.truth.p_EB, sim::q_EB_of(tick.truth.attitude)});
    if (tick.exposed && tick.truth.p_EB.z() < -kFlying)
      flight.moments.push_back({*tick.exposed, tick.pilot.target_gate()});
    return true;
  });
  return flight;
}

/// Every so manieth picture, so that lags are the Bebop's.
void keep_15_hz(Flown& flight, double rate) {
  const auto every = static_cast<std::size_t>(std::max(1.0, std::round(rate / 15.0)));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < flight.moments.size(); i += every)
    flight.moments[kept++] = flight.moments[i];
  flight.moments.resize(kept);
}

/// What is in a picture, whoever looks.
struct Scene {
  std::vector<sim::GateView> gates;
  std::vector<sim::LookAlike> two_gates, decoys;
  std::vector<int> places;
  const sim::GateView* target = nullptr;  ///< If it is whole in the picture.
  double target_distance = 1e9;           ///< [m]
};

std::optional<Kind> kind_of(const sim::GateView& view, const sim::GateView* largest) {
  if (&view == largest) return Kind::kGate;
  if (view.whole) return sim::detectable(view.corners_px) ? Kind::kOther : Kind::kAslant;
  if (sim::seen_corners(view) >= 2) return Kind::kHidden;
  return std::nullopt;
}

/// Whether two or more corners are reported and all of them are this gate's.
bool is_of(const GateDetection& cut, const sim::GateView& view) {
  int count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(cut.corner_fitness[i] > 0.0)) continue;
    const double off = (cut.corners_px[i] - view.corners_px[i]).norm();
    if (!view.drawn[i] || off > std::max(kSameParts, kSameCut * view.side_px)) return false;
    ++count;
  }
  return count >= 2;
}

bool parts_agree(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a - b).norm() < kSameParts;
}

/// One seed of one course.
class LookingAtSeed {
 public:
  LookingAtSeed(const simulated_race::Race& race, const Order& order, int nth_seed,
                int first_window, LooksOfBoth& looks)
      : config_{race.config},
        sim_{race.config.sim},
        nth_seed_{nth_seed},
        window_{first_window},
        looks_{looks},
        places_{sim::places_of(sim_.world, sim_.seed)} {
    if (order.ideal) {
      sight_ = std::make_unique<sim::SolidSight>(sim_.world);
      for (const char* name : {"ours", "paper"}) {
        world::IdealVisionParams params = sim_.ideal_vision;
        params.detector = name;
        drawn_.push_back(std::make_unique<sim::IdealVision>(sim_.world, sim_.camera, params,
                                                            sim_.seed, *sight_));
      }
    } else {
      renderer_ = std::make_unique<sim::CameraRenderer>(sim_.world, sim_.camera, sim_.light,
                                                        sim_.seed, sim_.cache_dir, 1);
    }
    const LookoutParams params = lookout_params(config_.pilot);
    eyes_.emplace_back(kOurs, params);
    if (order.paper) eyes_.emplace_back(kPaper, params);
    for (Looks& each : looks_) each.lights[nth_seed_] = light();
  }

  void look(const Flown& flight, std::size_t first, std::size_t last) {
    for (Eye& eye : eyes_) eye.forget();
    if (renderer_) renderer_->meter_anew();
    std::array<std::vector<Alarm>, kDetectors> alarms;
    for (std::size_t i = first; i < last; ++i)
      take(flight.moments[i], flight.poses, static_cast<int>(i - first), alarms);
    ++window_;
    for (std::size_t d = 0; d < kDetectors; ++d)
      looks_[d].alarms.insert(looks_[d].alarms.end(), alarms[d].begin(), alarms[d].end());
  }
  [[nodiscard]] int windows() const { return window_; }

 private:
  using AlarmsOfBoth = std::array<std::vector<Alarm>, kDetectors>;

  [[nodiscard]] SeedLight light() const {
    SeedLight result;
    for (const double gain : sim_.light.group_gain)
      result.brightness += std::log(gain) / world::LightConditions::kGroups;
    result.exposure = std::log(sim_.light.exposure_target);
    if (!sim_.world.gates.empty()) {
      const auto hue = [](const Eigen::Vector3d& rgb) {
        return std::atan2((rgb.y() - rgb.z()) / std::sqrt(2.0),
                          (2 * rgb.x() - rgb.y() - rgb.z()) / std::sqrt(6.0));
      };
      result.hue = hue(sim_.world.gates[0].color) - hue(world::WorldGate{}.color);
    }
    return result;
  }

  [[nodiscard]] const sim::Sight& sight() const {
    return renderer_ ? static_cast<const sim::Sight&>(*renderer_) : *sight_;
  }

  Scene scene_of(const Moment& moment, sim::Exposure& exposure,
                 std::span<const sim::BodyPose> history) {
    Scene scene;
    scene.gates = sim::gates_in_view(sim_.world, sim_.camera, sight(), moment.start, history);
    std::erase_if(scene.gates, [&](const sim::GateView& view) {
      return !sim_.world.gates[static_cast<std::size_t>(view.gate)].sought;
    });
    scene.two_gates = sim::frames_of_two(scene.gates);
    scene.decoys = sim::decoys_in_view(sim_.world, sight(), exposure);
    scene.places = sim::places_in_view(places_, sight(), exposure);
    for (const sim::GateView& view : scene.gates)
      if (view.gate == moment.target) {
        scene.target_distance = view.distance;
        if (view.whole && sim::detectable(view.corners_px)) scene.target = &view;
      }
    return scene;
  }

  void take(const Moment& moment, const std::vector<sim::BodyPose>& poses, int step,
            AlarmsOfBoth& alarms) {
    const double span = sim_.camera.exposure + sim_.camera.readout;
    const auto before = [](const sim::BodyPose& pose, double t) { return pose.t < t; };
    const auto from = std::lower_bound(poses.begin(), poses.end(), moment.start - 0.02, before);
    const auto to = std::lower_bound(from, poses.end(), moment.start + span + 0.02, before);
    const std::span<const sim::BodyPose> history{from, to};
    sim::Exposure exposure{sim_.camera, moment.start, history};
    const Scene scene = scene_of(moment, exposure, history);
    if (renderer_) renderer_->render(++frame_, moment.start, history, bytes_);
    const Image image{bytes_.data(), PixelFormat::kUyvy, sim_.camera.stored_width,
                      sim_.camera.stored_height, sim_.camera.stored_rotation};
    for (std::size_t d = 0; d < eyes_.size(); ++d) {
      const Answer answer =
          renderer_ ? eyes_[d].look(image, scene.target ? std::optional{scene.target->corners_px}
                                                        : std::nullopt)
                    : drawn(*drawn_[d], moment.start, history);
      judge(answer, scene, static_cast<Detector>(d), step, exposure, alarms[d]);
    }
  }

  static Answer drawn(sim::IdealVision& vision, double start,
                      std::span<const sim::BodyPose> history) {
    const sim::SeenPicture seen = vision.look(start, history);
    Answer answer;
    for (const auto& gate : seen.gates)
      answer.gates.push_back({.corners_px = gate.corners_px, .fitness = gate.fitness});
    if (seen.lower) answer.lower = LowerCorners{seen.lower->left_px, seen.lower->right_px, 1.0};
    if (seen.bars) answer.bars = GateBars{seen.bars->left_px, seen.bars->right_px};
    if (!seen.cut) return answer;
    answer.cut = GateDetection{.corners_px = seen.cut->corners_px};
    for (std::size_t i = 0; i < 4; ++i)
      answer.cut->corner_fitness[i] = seen.cut->seen[i] ? 1.0 : 0.0;
    return answer;
  }

  [[nodiscard]] Look look_of(int step, int which, const Quad& truth) const {
    return {.seed = nth_seed_,
            .window = window_,
            .step = step,
            .which = which,
            .side_px = side_of(truth),
            .truth = truth};
  }

  void judge(const Answer& answer, const Scene& scene, Detector detector, int step,
             sim::Exposure& exposure, std::vector<Alarm>& alarms) {
    Looks& looks = looks_[detector];
    ++looks.pictures;
    std::vector<const GateDetection*> open;
    for (const GateDetection& gate : answer.gates) open.push_back(&gate);
    std::set<const GateDetection*> gates;
    const auto claim = [&](Kind kind, int which, const Quad& truth, const auto& belongs) {
      Look look = look_of(step, which, truth);
      const auto found = std::find_if(
          open.begin(), open.end(), [&](const GateDetection* d) { return belongs(d->corners_px); });
      if (found != open.end()) {
        look.hit = true, look.fitness = (*found)->fitness, look.seen = (*found)->corners_px;
        if (kind <= Kind::kHidden) gates.insert(*found);
        open.erase(found);
      }
      looks[kind].push_back(look);
    };
    const auto at_least = [](const Quad& truth, double part) {
      return [&truth, part](const Quad& seen) { return overlaps(seen, truth, part); };
    };
    const sim::GateView* largest = sim::largest_of(scene.gates);
    for (const sim::GateView& view : scene.gates)
      if (const auto kind = kind_of(view, largest))
        claim(*kind, view.gate, view.corners_px, at_least(view.corners_px, kSame));
    for (const sim::LookAlike& frame : scene.two_gates)
      claim(Kind::kTwoGates, frame.which, frame.corners_px, at_least(frame.corners_px, 0.5));
    for (const sim::GateView& view : scene.gates)
      if (kind_of(view, largest))
        claim(Kind::kCrooked, view.gate, view.corners_px, at_least(view.corners_px, kOfGate));
    for (const sim::LookAlike& decoy : scene.decoys)
      claim(Kind::kDecoy, decoy.which, decoy.corners_px, [&](const Quad& seen) {
        const double near = 0.7 * side_of(seen);
        const Eigen::Vector2d at = center(seen), low = decoy.corners_px[0],
                              high = decoy.corners_px[2];
        return (at - at.cwiseMax(low).cwiseMin(high)).norm() < near;
      });
    for (const int place : scene.places) looks[Kind::kPlace].push_back(look_of(step, place, {}));
    remember(open, step, exposure, alarms);
    for (std::size_t i = 0; i < answer.gates.size(); ++i) {
      const GateDetection& found = answer.gates[i];
      (gates.contains(&found) ? looks.of_gates : looks.of_others)
          .push_back(sim::fields_of(found.corners_px, found.fitness, i));
    }
    parts(answer, scene, detector, step);
  }

  /// Alarms at no known thing, and those before that come again.
  void remember(const std::vector<const GateDetection*>& open, int step, sim::Exposure& exposure,
                std::vector<Alarm>& alarms) const {
    std::vector<Alarm> now;
    for (const GateDetection* gate : open) {
      const auto direction_E = exposure.direction_E(center(gate->corners_px));
      if (direction_E)
        now.push_back({.seed = nth_seed_,
                       .window = window_,
                       .step = step,
                       .fitness = gate->fitness,
                       .side_px = side_of(gate->corners_px),
                       .direction_E = *direction_E});
    }
    for (Alarm& alarm : alarms) {
      const auto later = static_cast<std::size_t>(step - alarm.step - 1);
      if (later >= alarm.again.size()) continue;
      const auto px = exposure.project(exposure.eye_E() + 100.0 * alarm.direction_E);
      alarm.in_view[later] = px && exposure.inside(*px);
      alarm.again[later] =
          alarm.in_view[later] && std::any_of(now.begin(), now.end(), [&](const Alarm& other) {
            return (other.direction_E - alarm.direction_E).norm() < kAgain;
          });
    }
    alarms.insert(alarms.end(), now.begin(), now.end());
  }

  void parts(const Answer& answer, const Scene& scene, Detector detector, int step) {
    Looks& looks = looks_[detector];
    bool lower_is_of_gate = false, bars_are_of_gate = false, lower_asked = false,
         bars_asked = false;
    for (const sim::GateView& view : scene.gates) {
      const Quad& c = view.corners_px;
      if (answer.lower && parts_agree(answer.lower->bottom_left_px, c[3]) &&
          parts_agree(answer.lower->bottom_right_px, c[2]))
        lower_is_of_gate = true;
      if (!lower_asked && view.only_lower_corners && view.distance < kLowerReach * target_side_) {
        lower_asked = true;
        Look look = look_of(step, view.gate, c);
        look.hit = lower_is_of_gate;
        if (look.hit)
          look.seen[3] = answer.lower->bottom_left_px, look.seen[2] = answer.lower->bottom_right_px;
        looks[Kind::kLower].push_back(look);
      }
      if (!view.bars_px) continue;
      const auto& [left, right] = *view.bars_px;
      if (answer.bars && std::abs(answer.bars->left_px.x() - left.x()) < kSameParts &&
          std::abs(answer.bars->right_px.x() - right.x()) < kSameParts)
        bars_are_of_gate = true;
      if (bars_asked || view.distance > kBarsReach * target_side_) continue;
      bars_asked = true;
      Look look = look_of(step, view.gate, {left, right, right, left});
      look.hit = bars_are_of_gate;
      if (look.hit) look.seen = {answer.bars->left_px, answer.bars->right_px, right, left};
      looks[Kind::kBars].push_back(look);
    }
    // The pilot asks for parts near the gate only.
    if (detector == kOurs && scene.target_distance > kPartsFrom * target_side_) return;
    cut(answer, scene, looks, step);
    Look lower = look_of(step, 0, {}), bars = look_of(step, 0, {});
    lower.hit = answer.lower && !lower_is_of_gate;
    if (lower.hit)
      lower.seen[3] = answer.lower->bottom_left_px, lower.seen[2] = answer.lower->bottom_right_px;
    bars.hit = answer.bars && !bars_are_of_gate;
    if (bars.hit) bars.seen = {answer.bars->left_px, answer.bars->right_px, {0, 0}, {0, 0}};
    looks[Kind::kFalseLower].push_back(lower), looks[Kind::kFalseBars].push_back(bars);
  }

  /// The nearest gate that the border cuts.
  void cut(const Answer& answer, const Scene& scene, Looks& looks, int step) const {
    const auto is_cut = [](const sim::GateView& view) {
      return sim::cut_kind(view.seen).has_value();
    };
    const auto nearest = std::find_if(scene.gates.begin(), scene.gates.end(), is_cut);
    if (nearest != scene.gates.end() && nearest->distance < kPartsFrom * target_side_) {
      Look look = look_of(step, nearest->gate, nearest->corners_px);
      look.side_px = nearest->side_px, look.in_view = nearest->seen;
      look.hit = answer.cut && is_of(*answer.cut, *nearest);
      for (std::size_t i = 0; look.hit && i < 4; ++i)
        look.hit = !nearest->seen[i] || answer.cut->corner_fitness[i] > 0.0;
      if (look.hit) look.seen = answer.cut->corners_px;
      looks[Kind::kCut].push_back(look);
    }
    Look wrong = look_of(step, 0, {});
    const auto& fitness = answer.cut ? answer.cut->corner_fitness : std::array<double, 4>{};
    wrong.hit =
        std::count_if(fitness.begin(), fitness.end(), [](double f) { return f > 0.0; }) > 1 &&
        std::none_of(scene.gates.begin(), scene.gates.end(),
                     [&](const auto& view) { return is_of(*answer.cut, view); });
    if (wrong.hit) wrong.seen = answer.cut->corners_px;
    looks[Kind::kFalseCut].push_back(wrong);
  }

  const simulated_race::RaceConfig& config_;
  const world::SimConfig& sim_;
  /// Reaches are of gates of 1 m; of wide ones they grow with the side.
  const double target_side_ = sim::build_of(sim_.world.gates) == sim::GateBuild::kWide
                                  ? config_.pilot.track.gates.front().side
                                  : 1.0;
  int nth_seed_, window_;
  LooksOfBoth& looks_;
  std::vector<sim::Place> places_;
  std::unique_ptr<sim::CameraRenderer> renderer_;
  std::unique_ptr<sim::SolidSight> sight_;
  std::vector<std::unique_ptr<sim::IdealVision>> drawn_;
  std::vector<Eye> eyes_;
  std::vector<std::uint8_t> bytes_;
  std::uint32_t frame_ = 0;
};

}  // namespace

void look_at(const Order& order, LooksOfBoth& looks) {
  const simulated_race::RaceMaker maker{{.config = {.configs = order.configs, .settings = {}},
                                         .track = order.track,
                                         .vision = "ideal",
                                         .laps = {}}};
  const auto& lights = looks[kOurs].lights;
  int nth_seed = lights.empty() ? 0 : lights.rbegin()->first + 1, window = 1000 * nth_seed;
  for (int i = 0; i < order.seeds; ++i, ++nth_seed) {
    const simulated_race::Race race = maker.race(order.first_seed + static_cast<std::uint64_t>(i));
    Flown flight = flown(race.config);
    keep_15_hz(flight, race.config.sim.sensors.camera_hz);
    std::fprintf(stderr, "\r%-20s seed %llu ", order.track.c_str(),
                 static_cast<unsigned long long>(race.identity.seed));
    LookingAtSeed looking{race, order, nth_seed, window, looks};
    const auto count = flight.moments.size();
    const auto length = std::min(count, static_cast<std::size_t>(order.pictures));
    if (length == 0) continue;
    sim::Stream stream{race.identity.seed, "pictures"};
    const double share = static_cast<double>(count - length) / order.windows,
                 phase = stream.uniform();
    for (int w = 0; w < order.windows; ++w) {
      const auto first = static_cast<std::size_t>((w + phase) * share);
      looking.look(flight, first, first + length);
    }
    window = looking.windows();
  }
}

}  // namespace gatefly::measuring
