// SPDX-License-Identifier: Apache-2.0
// The smoother against the truth of simulated races, and the maps that races teach.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "gatefly/closed_loop/race.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/smoothing/learnt_map.hpp"
#include "gatefly/smoothing/track_with_map.hpp"

#include "support/race_setup.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
using smoothing::FlightMap;
using smoothing::Intake;
using smoothing::Smoothed;

closed_loop::RaceConfig ideal_race(std::uint64_t seed) {
  closed_loop::RaceConfig race = test::race_on("showroom", seed, 3);
  race.vision = closed_loop::Vision::kIdeal;
  race.pilot.filter_model = FilterModel::kOurs;
  return race;
}

/// What was believed in a tick, and what was.
struct Row {
  double time = 0.0;
  std::size_t target = 0;
  Vector3d true_p_EB, p_GB;
};

struct Flown {
  closed_loop::RaceResult result;
  std::vector<Row> rows;
  Intake intake;
};

Flown flown(const closed_loop::RaceConfig& race) {
  Flown flight;
  smoothing::IntakeWatch watch;
  flight.result = closed_loop::fly(race, [&](const Tick& tick) {
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

Vector3d truth_of(const Row& row, const closed_loop::RaceConfig& race) {
  const sim::WorldGate& gate = race.sim.world.gates[row.target];
  return from_gate(gate.p_EG, gate.yaw_EG, row.true_p_EB);
}

Vector3d smoothed_at(const Row& row, const Smoothed& smoothed, const Vector3d& p_EB) {
  const eskf::GateBelief& gate = smoothed.gates[row.target];
  return from_gate(gate.p_EG, gate.yaw_EG, p_EB);
}

// NEES of the place relative to the next gate, north and east of it, which the gates show.
double mean_nees(const Flown& flight, const Smoothed& smoothed,
                 const closed_loop::RaceConfig& race) {
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
    EXPECT_LT(smoother2, 0.7 * 0.7 * filter2) << seed;
    by_filter += filter2, by_smoother += smoother2;
    nees += mean_nees(flight, smoothed, race) / kRaces;
    std::cout << seed << " from the gate, filter | smoothed " << std::sqrt(filter2 / double(flight.rows.size())) << " | " << std::sqrt(smoother2 / double(flight.rows.size())) << " m, NEES/3 " << mean_nees(flight, smoothed, race) << ", filter's " << flight.result.consistency.nees.sum_per_dof / flight.result.consistency.nees.samples << std::endl;
  }
  EXPECT_LT(by_smoother, 0.6 * 0.6 * by_filter);
  EXPECT_GT(nees, 0.4);
  EXPECT_LT(nees, 2.5);
}

// Another flight through the same room: other noise of the sensors, the same gates, drone and camera.
closed_loop::RaceConfig again(closed_loop::RaceConfig race, std::uint64_t noise) {
  race.sim.seed = noise;
  return race;
}

Eigen::VectorXd errors_of(const Track& map, const sim::World& world) {
  Eigen::VectorXd errors(eskf::kPerGate * static_cast<int>(map.gates.size()));
  for (std::size_t i = 0; i < map.gates.size(); ++i) {
    const MapGate& gate = map.gates[i];
    errors.segment<eskf::kPerGate>(eskf::kPerGate * static_cast<int>(i))
        << gate.p_EG - world.gates[i].p_EG,
        wrap_angle(gate.yaw_EG - world.gates[i].yaw_EG), gate.side / world.gates[i].side - 1.0;
  }
  return errors;
}

/// RMS over all gates of the place on the floor plan [m], without what all have in common.
double misplaced(const Track& map, const sim::World& world, const Intake& intake) {
  Eigen::VectorXd information(eskf::kPerGate * static_cast<int>(map.gates.size()));
  for (std::size_t i = 0; i < map.gates.size(); ++i)
    information.segment<eskf::kPerGate>(eskf::kPerGate * static_cast<int>(i)) =
        prior_of(eskf::Landmark{}, intake.setup.params.priors).cwiseAbs2().cwiseInverse();
  const Eigen::VectorXd off =
      smoothing::without_common(intake.landmarks, information) * errors_of(map, world);
  double sum = 0.0;
  for (std::size_t i = 0; i < map.gates.size(); ++i)
    sum += off.segment<2>(eskf::kPerGate * static_cast<int>(i)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(map.gates.size()));
}

TEST(SmoothedRace, TwoRacesTeachWhereTheGatesReallyStand) {
  double before = 0.0, after = 0.0, squares = 0.0;
  int numbers = 0, finished = 0;
  for (std::uint64_t seed : {1811u, 1812u, 1813u}) {
    const auto race = ideal_race(seed);
    std::vector<FlightMap> maps;
    Intake intake;
    for (std::uint64_t noise : {seed, seed + 50}) {
      const Flown flight = flown(again(race, noise));
      intake = flight.intake;
      maps.push_back(smoothing::map_of(smoothing::smooth(intake), intake));
    }
    const auto map = smoothing::fused(maps, intake.setup.params.priors);
    const Track learnt = smoothing::with_map(race.pilot.track, map, intake);
    before += std::pow(misplaced(race.pilot.track, race.sim.world, intake), 2);
    after += std::pow(misplaced(learnt, race.sim.world, intake), 2);
    EXPECT_LT(*std::max_element(map.worst.begin(), map.worst.end()), 4.0) << seed;

    // The same truth, flown by a pilot with the learnt map.
    auto with_learnt = again(race, seed + 90);
    with_learnt.pilot.track = learnt;
    finished += closed_loop::fly(with_learnt, {}).finished;

    Eigen::VectorXd information(eskf::kPerGate * static_cast<int>(learnt.gates.size()));
    for (std::size_t i = 0; i < learnt.gates.size(); ++i)
      information.segment<eskf::kPerGate>(eskf::kPerGate * static_cast<int>(i)) =
          prior_of(eskf::Landmark{}, intake.setup.params.priors).cwiseAbs2().cwiseInverse();
    const Eigen::VectorXd off = smoothing::without_common(intake.landmarks, information) *
                                errors_of(learnt, race.sim.world);
    for (std::size_t i = 0; i < learnt.gates.size(); ++i)
      for (int axis = 0; axis < 2; ++axis, ++numbers)
        squares += std::pow(off(eskf::kPerGate * static_cast<int>(i) + axis) /
                                (*learnt.gates[i].position_sigma)(axis),
                            2);
  }
  std::cout << "BEFORE " << std::sqrt(before / 3) << " AFTER " << std::sqrt(after / 3) << " "
            << squares / numbers << " finished " << finished << std::endl;
  EXPECT_LT(after, 0.6 * 0.6 * before);
  EXPECT_GT(squares / numbers, 0.3);
  EXPECT_LT(squares / numbers, 3.0);
  EXPECT_EQ(finished, 3);
}

}  // namespace
}  // namespace gatefly
