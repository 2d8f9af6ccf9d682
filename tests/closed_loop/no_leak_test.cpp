// SPDX-License-Identifier: Apache-2.0
// Ideal vision may not tell a pilot more than the real detector does.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/detection/quad.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/detector_statistics.hpp"
#include "gatefly/sim/gates_in_view.hpp"
#include "gatefly/sim/solids.hpp"
#include "gatefly/sim/told_apart.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

/// Readable fields of detections, of gates and of what is none.
struct Read {
  std::vector<sim::Fields> of_gates, of_others;
};

bool is_gate(const Quad& corners, const std::vector<sim::GateView>& views) {
  constexpr double kSame = 0.7;  // as tools/detector_statistics has it
  return std::any_of(views.begin(), views.end(), [&](const sim::GateView& view) {
    return (view.whole || sim::seen_corners(view) >= 2) &&
           overlaps(corners, view.corners_px, kSame);
  });
}

void read_flight(RaceConfig race, const std::string& detector, Read& read) {
  race.vision = Vision::kIdeal;
  race.sim.ideal_vision.detector = detector;
  race.pilot.phase.first_gate_timeout = 0.0;  // with the paper's eye it would wait, and land
  const sim::SolidSight sight{race.sim.world};
  constexpr double kRow = 1.0;  // [s]
  double last_other = -kRow;
  std::vector<sim::BodyPose> poses;
  (void)fly(race, [&](const flight_log::Tick& tick) {
    poses.push_back({1e-9 * static_cast<double>(tick.sensors.time.count()), tick.truth.p_EB,
                     sim::q_EB_of(tick.truth.attitude)});
    if (!tick.sensors.seen || !tick.exposed) return true;
    const auto views =
        sim::gates_in_view(race.sim.world, race.sim.camera, sight, *tick.exposed, poses);
    const auto& seen = tick.sensors.seen->gates;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const GateDetection& found = seen[i];
      // The rest of what a pilot can read is the same of all.
      EXPECT_EQ(found.method, DetectionMethod::kSnake);
      EXPECT_TRUE(found.whole);
      EXPECT_EQ(found.corner_fitness, (std::array<double, 4>{1.0, 1.0, 1.0, 1.0}));
      const sim::Fields fields = sim::fields_of(found.corners_px, found.fitness, i);
      if (is_gate(found.corners_px, views)) {
        read.of_gates.push_back(fields);
      } else if (const double now = poses.back().t; now - last_other > kRow) {
        // One of a row of pictures: what is taken for a gate once is taken for one again.
        read.of_others.push_back(fields), last_other = now;
      }
    }
    return true;
  });
}

std::vector<double> column(const std::vector<sim::Fields>& rows, std::size_t field) {
  std::vector<double> values;
  for (const sim::Fields& row : rows) values.push_back(row[field]);
  return values;
}

TEST(IdealVisionInFlight, NoFieldOfADetectionTellsMoreThanWithTheRealDetectorOnPictures) {
  for (const char* detector : {"ours", "paper"}) {
    Read read;
    for (const std::uint64_t seed : {1001u, 1002u, 1003u, 1004u, 1005u, 1006u, 1007u, 1008u})
      for (const char* track : {"oval", "showroom"})
        read_flight(test::race_on(track, seed, 1), detector, read);
    ASSERT_GT(read.of_gates.size(), 500u);
    ASSERT_GT(read.of_others.size(), 30u);
    const sim::Fields& real = sim::statistics_of(detector).told;
    ASSERT_NE(real, sim::Fields{}) << "not in the table: tools/detector_statistics/renew.sh";
    // Two standard errors of Kolmogorov's distance of so many.
    const double error = 2.0 / std::sqrt(static_cast<double>(read.of_others.size()));
    for (std::size_t field = 0; field < real.size(); ++field)
      EXPECT_LT(sim::told_apart(column(read.of_gates, field), column(read.of_others, field)),
                real[field] + error)
          << detector << ": " << sim::kFields[field] << ", " << read.of_others.size();
  }
}

TEST(ToldApart, IsOneForTwoKindsThatNeverMixAndNothingForOneKind) {
  EXPECT_EQ(sim::told_apart({1, 2, 3}, {4, 5}), 1.0);
  EXPECT_EQ(sim::told_apart({1, 2, 3}, {1, 2, 3}), 0.0);
  EXPECT_NEAR(sim::told_apart({1, 2, 3, 4}, {3, 4, 5, 6}), 0.5, 1e-12);
  EXPECT_EQ(sim::told_apart({}, {1}), 0.0);
}

}  // namespace
}  // namespace gatefly::simulated_race
