// SPDX-License-Identifier: Apache-2.0
// The smoother against the truth of simulated races, and the maps that races
// teach.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"
#include "gatefly/tasks/smoothing/learnt_map.hpp"
#include "gatefly/tasks/smoothing/track_with_map.hpp"

#include "support/race_setup.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
using smoothing::FlightMap;
using smoothing::Intake;
using smoothing::Smoothed;

simulated_race::RaceConfig ideal_race(std::uint64_t seed) {
  simulated_race::RaceConfig race = test::race_on("showroom", seed, 3);
  race.vision = simulated_race::Vision::kIdeal;
  race.pilot.filter_model = FilterModel::kOurs;
  return race;
}

/// A tick's belief, and the truth.
struct Row {
  double time = 0.0;
  std::size_t target = 0;
  Vector3d true_p_EB, p_GB;
};

struct Flown {
  simulated_race::RaceResult result;
  std::vector<Row> rows;
  Intake intake;
};

Flown flown(const simulated_race::RaceConfig& race) {
  Flown flight;
  smoothing::IntakeWatch watch;
  flight.result = simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    watch.update(*tick.pilot.navigator().error_state(), tick.sensors.seen.has_value());
    if (watch.has_started())
      flight.rows.push_back({1e-9 * static_cast<double>(tick.sensors.time.count()),
                             static_cast<std::size_t>(tick.pilot.target_gate()), tick.truth.p_EB,
                             tick.pilot.estimate().p_GB});
    return true;
  });
  flight.intake = watch.intake();
  return flight;
}

Vector3d from_gate(const Vector3d& p_EG, double yaw_EG, const Vector3d& p_EB) {
  return rotation_z(-yaw_EG) * (p_EB - p_EG);
}

Vector3d truth_of(const Row& row, const simulated_race::RaceConfig& race) {
  const world::WorldGate& gate = race.sim.world.gates[row.target];
  return from_gate(gate.p_EG, gate.yaw_EG, row.true_p_EB);
}

Vector3d smoothed_at(const Row& row, const Smoothed& smoothed, const Vector3d& p_EB) {
  const eskf::GateBelief& gate = smoothed.gates[row.target];
  return from_gate(gate.p_EG, gate.yaw_EG, p_EB);
}

// NEES of the place relative to the next gate, north and east of it, which the
// gates show.
double mean_nees(const Flown& flight, const Smoothed& smoothed,
                 const simulated_race::RaceConfig& race) {
  double sum = 0.0;
  for (const smoothing::Certainty& certainty : smoothed.certainties) {
    const smoothing::Moment& moment = smoothed.path[certainty.moment];
    const auto row = std::lower_bound(flight.rows.begin(), flight.rows.end(), moment.time,
                                      [](const Row& r, double t) { return r.time < t; });
    if (row == flight.rows.end()) continue;
    const Vector3d p = smoothed_at(*row, smoothed, moment.x.p_EB);
    const Eigen::Matrix3d R_GE = rotation_z(-smoothed.gates[row->target].yaw_EG);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, certainty.P.rows());
    const int gate = eskf::gate_at(static_cast<int>(row->target));
    J.leftCols<3>() = R_GE;
    J.middleCols<3>(gate) = -R_GE;
    J.col(gate + eskf::kGateYaw) << p.y(), -p.x(), 0.0;
    const Vector3d error = p - truth_of(*row, race);
    const Eigen::Matrix3d P = J * certainty.P * J.transpose();
    sum += error.dot(P.ldlt().solve(error)) / 3.0;
  }
  return sum / static_cast<double>(smoothed.certainties.size());
}

// Four races are some 15 s of CPU.
TEST(SmoothedRace, IsAtMostSevenTenthsAsFarFromTheGateAsTheFilter) {
  double by_filter = 0.0, by_smoother = 0.0, nees = 0.0;
  constexpr int kRaces = 4;
  for (std::uint64_t seed = 1801; seed < 1801 + kRaces; ++seed) {
    const auto race = ideal_race(seed);
    const Flown flight = flown(race);
    const Smoothed smoothed = smoothing::smooth(flight.intake);
    EXPECT_TRUE(smoothed.settled) << seed;
    double filter2 = 0.0, smoother2 = 0.0;
    for (const Row& row : flight.rows) {
      const Vector3d truth = truth_of(row, race);
      filter2 += (row.p_GB - truth).squaredNorm();
      const Vector3d p_EB = smoothing::at(smoothed, row.time).p_EB;
      smoother2 += (smoothed_at(row, smoothed, p_EB) - truth).squaredNorm();
    }
    EXPECT_LT(smoother2, filter2) << seed;
    by_filter += filter2, by_smoother += smoother2;
    nees += mean_nees(flight, smoothed, race) / kRaces;
  }
  EXPECT_LT(by_smoother, 0.6 * 0.6 * by_filter);
  EXPECT_GT(nees, 0.4);
  EXPECT_LT(nees, 2.5);
}

// Another flight through the same room: other noise of the sensors, the same
// gates, drone and camera.
simulated_race::RaceConfig again(simulated_race::RaceConfig race, std::uint64_t noise) {
  race.sim.seed = noise;
  return race;
}

/// Errors of a map's gates, without what all of them have in common.
Eigen::VectorXd errors_within(const Track& map, const world::World& world, const Intake& intake) {
  Eigen::VectorXd errors(eskf::gate_at(static_cast<int>(map.gates.size())) - eskf::kGates);
  Eigen::VectorXd information = errors;
  for (std::size_t i = 0; i < map.gates.size(); ++i) {
    const MapGate& gate = map.gates[i];
    const Eigen::Index at = eskf::kPerGate * static_cast<Eigen::Index>(i);
    errors.segment<eskf::kPerGate>(at) << gate.p_EG - world.gates[i].p_EG,
        wrap_angle(gate.yaw_EG - world.gates[i].yaw_EG), gate.side / world.gates[i].side - 1.0;
    information.segment<eskf::kPerGate>(at) =
        prior_of(eskf::Landmark{}, intake.setup.params.priors).cwiseAbs2().cwiseInverse();
  }
  return smoothing::without_common(intake.landmarks, information) * errors;
}

/// Two flights through a room, and what they teach.
struct Taught {
  Track map;
  Intake intake;
  double worst = 0.0;
};

Taught taught_by_two(const simulated_race::RaceConfig& race) {
  Taught taught;
  std::vector<FlightMap> maps;
  for (std::uint64_t noise : {race.sim.seed, race.sim.seed + 50}) {
    taught.intake = flown(again(race, noise)).intake;
    maps.push_back(smoothing::map_of(smoothing::smooth(taught.intake), taught.intake));
  }
  const auto map = smoothing::fused(maps, taught.intake.setup.params.priors);
  taught.map = smoothing::with_map(race.pilot.track, map, taught.intake);
  taught.worst = *std::max_element(map.worst.begin(), map.worst.end());
  return taught;
}

// Three rooms: the gates of a room stand 2 to 25 cm from where the map has
// them.
TEST(SmoothedRace, TwoRacesTeachWhereTheGatesReallyStand) {
  double before = 0.0, after = 0.0, in_sigmas = 0.0;
  int numbers = 0, finished = 0;
  for (std::uint64_t seed : {1811u, 1812u, 1813u}) {
    const auto race = ideal_race(seed);
    const Taught taught = taught_by_two(race);
    EXPECT_LT(taught.worst, 4.0) << seed;
    const auto old = errors_within(race.pilot.track, race.sim.world, taught.intake);
    const auto now = errors_within(taught.map, race.sim.world, taught.intake);
    for (std::size_t gate = 0; gate < taught.map.gates.size(); ++gate)
      for (int axis = 0; axis < 2; ++axis, ++numbers) {
        const Eigen::Index i = eskf::kPerGate * static_cast<Eigen::Index>(gate) + axis;
        const double sigma = (*taught.map.gates[gate].position_sigma)(axis);
        before += old(i) * old(i), after += now(i) * now(i);
        in_sigmas += now(i) * now(i) / (sigma * sigma);
      }
    // The same room, flown by a pilot with the learnt map: it believes its
    // sigmas.
    auto with_learnt = again(race, seed + 90);
    with_learnt.pilot.track = taught.map;
    const Flown flight = flown(with_learnt);
    finished += flight.result.finished;
    EXPECT_EQ((*flight.intake.setup.map[2].sigmas)(1), taught.map.gates[2].position_sigma->y());
  }
  EXPECT_LT(after, 0.5 * 0.5 * before);
  EXPECT_GT(in_sigmas / numbers, 0.3);  // 30 numbers that are not independent
  EXPECT_LT(in_sigmas / numbers, 2.5);
  EXPECT_EQ(finished, 3);
}

}  // namespace
}  // namespace gatefly
