// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/labelled_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gatefly/config/track_keys.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/solids.hpp"
#include "gatefly/simulated_race/varied_look.hpp"

namespace gatefly::simulated_race {
namespace {

/// A moment to take a picture at, and the motion about it.
struct PictureMoment {
  double start = 0.0;  ///< Begin of the exposure [s].
  std::vector<sim::BodyPose> history;
  bool around = false;
};

sim::BodyPose pose_of(double t, const Eigen::Vector3d& p_EB, const Attitude& attitude) {
  return {t, p_EB, sim::q_EB_of(attitude)};
}

/// Every exposure of an ideal race, with the motion during it.
std::vector<PictureMoment> moments_of_race(RaceConfig race, const std::function<void()>& between) {
  constexpr double kFlying = 0.5;  // on the pad there is nothing to see [m]
  race.vision = Vision::kIdeal;
  race.pilot.track.laps = 1;  // the others look alike
  std::vector<sim::BodyPose> poses;
  std::vector<double> starts;
  (void)fly(race, [&](const flight_log::Tick& tick) {
    if (between) between();
    const double t = 1e-9 * static_cast<double>(tick.sensors.time.count());
    poses.push_back(pose_of(t, tick.truth.p_EB, tick.truth.attitude));
    if (tick.exposed && tick.truth.p_EB.z() < -kFlying) starts.push_back(*tick.exposed);
    return true;
  });
  const double span = race.sim.camera.exposure + race.sim.camera.readout;
  std::vector<PictureMoment> moments;
  for (const double start : starts) {
    const auto before = [](const sim::BodyPose& pose, double t) { return pose.t < t; };
    auto from = std::lower_bound(poses.begin(), poses.end(), start, before);
    auto to = std::lower_bound(poses.begin(), poses.end(), start + span, before);
    if (from == poses.begin() || to == poses.end()) continue;
    moments.push_back({start, {from - 1, to + 1}, false});
  }
  return moments;
}

/// Whether a drone could be there.
bool is_free(const sim::Sight& sight, const Eigen::Vector3d& p_E) {
  constexpr double kRoom = 0.3;  // [m]
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-0.5, 0.0, 0.5}) {
        const Eigen::Vector3d way{x, y, z};
        if (!way.isZero() && sight.range(p_E, way.normalized(), kRoom) < kRoom) return false;
      }
  return true;
}

class AroundTheRoom {
 public:
  AroundTheRoom(const world::SimConfig& config, std::uint64_t seed,
                const std::function<void()>& between)
      : config_{config}, sight_{config.world}, stream_{seed, "poses"}, between_{between} {}

  PictureMoment next() {
    const Eigen::Vector2d half = 0.5 * config_.world.room_size.head<2>();
    for (;;) {
      if (between_) between_();
      const auto index = static_cast<std::size_t>(
          stream_.uniform(0.0, static_cast<double>(config_.world.gates.size())));
      const world::WorldGate& gate = config_.world.gates[index];
      const double distance = stream_.uniform(0.8, 7.0);
      const double aside =
          stream_.uniform(-60.0, 60.0) * kDegree + (stream_.uniform() < 0.15 ? kPi : 0.0);
      const double bearing = gate.yaw_EG + aside;
      const Eigen::Vector3d p{gate.p_EG.x() - distance * gatefly::cos(bearing),
                              gate.p_EG.y() - distance * gatefly::sin(bearing),
                              std::clamp(gate.p_EG.z() + 0.3 * stream_.normal(),
                                         0.4 - config_.world.room_size.z(), -0.4)};
      const bool anywhere = stream_.uniform() < 0.2;
      const Attitude attitude{.roll = 8.0 * kDegree * stream_.normal(),
                              .pitch = (-3.0 + 5.0 * stream_.normal()) * kDegree,
                              .yaw = anywhere ? stream_.uniform(-kPi, kPi)
                                              : bearing + 12.0 * kDegree * stream_.normal()};
      const double speed = stream_.uniform(0.0, 2.5);
      const Eigen::Vector3d v{speed * gatefly::cos(attitude.yaw),
                              speed * gatefly::sin(attitude.yaw), 0.2 * stream_.normal()};
      const Eigen::Vector3d turn{0.5 * stream_.normal(), 0.3 * stream_.normal(),
                                 0.4 * stream_.normal()};
      const Eigen::Vector2d off = (p.head<2>() - config_.world.room_center).cwiseAbs();
      if ((off.array() > half.array() - 0.3).any() || !is_free(sight_, p)) continue;
      PictureMoment moment{0.0, {}, true};
      for (const double t : {-0.02, 0.0, 0.02, 0.04, 0.06})
        moment.history.push_back(pose_of(t, p + t * v,
                                         {.roll = attitude.roll + t * turn.x(),
                                          .pitch = attitude.pitch + t * turn.y(),
                                          .yaw = attitude.yaw + t * turn.z()}));
      return moment;
    }
  }

 private:
  const world::SimConfig& config_;
  sim::SolidSight sight_;
  sim::Stream stream_;
  const std::function<void()>& between_;
};

/// The same motion seen by a camera that is held otherwise.
void shake(PictureMoment& moment, double sigma, sim::Stream& stream) {
  const Attitude off{.roll = sigma * stream.normal(),
                     .pitch = 0.5 * sigma * stream.normal(),
                     .yaw = 0.8 * sigma * stream.normal()};
  for (sim::BodyPose& pose : moment.history) {
    Attitude a = attitude_of({sim::R_EB_of(pose.q_EB.normalized())});
    a.roll += off.roll, a.pitch += off.pitch, a.yaw += off.yaw;
    pose.q_EB = sim::q_EB_of(a);
  }
}

/// So many of them, evenly spread over the race.
std::vector<PictureMoment> chosen(std::vector<PictureMoment> moments, std::size_t count,
                                  sim::Stream& stream) {
  if (moments.size() <= count) return moments;
  const double step = static_cast<double>(moments.size()) / static_cast<double>(count);
  const double phase = stream.uniform();
  std::vector<PictureMoment> kept;
  for (std::size_t i = 0; i < count; ++i)
    kept.push_back(
        std::move(moments[static_cast<std::size_t>((static_cast<double>(i) + phase) * step)]));
  return kept;
}

std::vector<PictureMoment> moments_of_seed(const Race& race, const PictureOrder& order,
                                           std::size_t count,
                                           const std::function<void()>& between) {
  sim::Stream stream{race.identity.seed, "pictures"};
  const auto from_race =
      count - static_cast<std::size_t>(std::lround(order.around * static_cast<double>(count)));
  std::vector<PictureMoment> moments;
  if (from_race > 0) moments = chosen(moments_of_race(race.config, between), from_race, stream);
  if (order.shake > 0.0)
    for (PictureMoment& moment : moments) shake(moment, order.shake, stream);
  AroundTheRoom around{race.config.sim, race.identity.seed, between};
  while (moments.size() < count) moments.push_back(around.next());
  return moments;
}

/// Looks take turns, the track's own first.
std::string look_of_seed(const std::string& own, std::size_t nth) {
  const auto& looks = config::track_key("room", "look").choices;
  const auto first = std::find(looks.begin(), looks.end(), own) - looks.begin();
  return looks[(static_cast<std::size_t>(first) + nth) % looks.size()];
}

std::vector<Eigen::Vector3d> places_of(const std::vector<PictureMoment>& moments) {
  std::vector<Eigen::Vector3d> places;
  for (const PictureMoment& moment : moments)
    for (const sim::BodyPose& pose : {moment.history.front(), moment.history.back()})
      places.push_back(pose.p_EB);
  return places;
}

}  // namespace

std::size_t seeds_of(const PictureOrder& order) {
  return (order.pictures + order.per_seed - 1) / order.per_seed;
}

void render_seed(const RaceMaker& maker, const PictureOrder& order, std::size_t nth,
                 const std::function<bool(Picture&&)>& each, const std::function<void()>& between) {
  Race race = maker.race(order.first_seed + nth);
  if (order.varied) race.config.sim.world.look = look_of_seed(race.config.sim.world.look, nth);
  const std::size_t first = nth * order.per_seed;
  const std::size_t count = std::min(order.per_seed, order.pictures - first);
  const std::vector<PictureMoment> moments = moments_of_seed(race, order, count, between);
  if (order.varied) vary(race.config.sim, race.identity.seed, places_of(moments));
  if (order.without_gates)
    for (world::WorldGate& gate : race.config.sim.world.gates) gate.missing = true;
  const world::SimConfig& s = race.config.sim;
  sim::CameraRenderer renderer{s.world, s.camera, s.light, s.seed, s.cache_dir, 1, between};
  const double middle = 0.5 * (s.camera.exposure + s.camera.readout);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const PictureMoment& moment = moments[i];
    Picture picture{.number = first + i, .seed = race.identity.seed, .around = moment.around};
    renderer.meter_anew();
    renderer.render(static_cast<std::uint32_t>(i + 1), moment.start, moment.history, picture.uyvy);
    picture.pose = sim::interpolated(moment.history, moment.start + middle);
    world::CameraTruth camera = s.camera;
    camera.exposure = renderer.exposure();  // bright light shortens it
    picture.gates = sim::gates_in_view(s.world, camera, renderer, moment.start, moment.history);
    if (order.masks) picture.mask = renderer.gate_mask(moment.start, moment.history);
    if (!each(std::move(picture))) return;
  }
}

}  // namespace gatefly::simulated_race
