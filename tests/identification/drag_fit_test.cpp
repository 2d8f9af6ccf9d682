// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/identification/drag_fit.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/generators.hpp"

namespace gatefly::identification {
namespace {

struct Drone {
  Eigen::Vector2d drag{-0.55, -0.45}, bias{0.2, -0.1};
  double heading_offset = 15.0 * kDegree;  ///< True heading − the log's.
};

/// A weaving flight of 8 s whose accelerometer shows drag, bias and noise, and nothing else.
flight_log::FlightFolder flown(const Drone& drone, double noise, std::uint64_t seed) {
  Rng rng{seed};
  flight_log::FlightFolder flight;
  Eigen::Vector3d p{0, 0, -1.4}, v = Eigen::Vector3d::Zero();
  constexpr double kStep = 1.0 / 512.0;
  for (int i = 0; i < 8 * 512; ++i) {
    const double t = i * kStep;
    const Attitude attitude{0.15 * std::sin(1.7 * t), -0.12 * std::cos(0.9 * t),
                            0.3 * std::sin(0.5 * t)};
    const Eigen::Matrix3d R = rotation_EB(attitude).matrix;
    const Eigen::Vector3d v_B = R.transpose() * v;
    // Thrust holds the height; what the accelerometer feels along x and y is drag.
    Eigen::Vector3d force_B{drone.drag.x() * v_B.x(), drone.drag.y() * v_B.y(), 0.0};
    force_B.z() = (-9.81 - (R * force_B).z()) / R(2, 2);
    flight_log::FlightSample s;
    s.time = std::chrono::nanoseconds{static_cast<std::int64_t>(1e9 * t)};
    s.imu.accel_B = force_B + Eigen::Vector3d{drone.bias.x() + noise * test::normal(rng),
                                              drone.bias.y() + noise * test::normal(rng),
                                              noise * test::normal(rng)};
    s.true_p_EB = p, s.true_v_E = v;
    Attitude logged = attitude;
    logged.yaw -= drone.heading_offset;
    s.ahrs = logged;
    flight.samples.push_back(s);
    v += kStep * (R * force_B + Eigen::Vector3d{0, 0, 9.81});
    p += kStep * v;
  }
  return flight;
}

TEST(DragFit, RecoversDragBiasAndHeading) {
  for (const double offset : {-30.0, 0.0, 15.0}) {
    Drone drone;
    drone.heading_offset = offset * kDegree;
    const auto fit = fit_drag(flown(drone, 0.0, 1));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->drag.x(), drone.drag.x(), 0.02);
    EXPECT_NEAR(fit->drag.y(), drone.drag.y(), 0.03);
    EXPECT_NEAR(fit->bias.x(), drone.bias.x(), 0.02);
    EXPECT_NEAR(fit->bias.y(), drone.bias.y(), 0.02);
    EXPECT_NEAR(fit->heading_offset, drone.heading_offset, 0.5 * kDegree);
    EXPECT_LT(fit->rms, 0.02);
  }
}

// A Bebop's motors shake its accelerometer, twenty flights: within three standard errors,
// nearly always.
TEST(DragFit, KnowsHowFarItIsOff) {
  int within = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Drone drone;
    const auto fit = fit_drag(flown(drone, 2.0, seed));
    ASSERT_TRUE(fit);
    within += std::abs(fit->drag.x() - drone.drag.x()) < 3.0 * fit->drag_sigma.x();
    EXPECT_NEAR(fit->drag.x(), drone.drag.x(), 0.1);
  }
  EXPECT_GE(within, 17);
}

TEST(DragFit, HeadingAloneIsFoundWhenDragIsKnown) {
  const Drone drone;
  DragFit known;
  known.drag = drone.drag, known.bias = drone.bias;
  EXPECT_NEAR(fit_heading(flown(drone, 0.0, 1), known), drone.heading_offset, 0.5 * kDegree);
}

TEST(DragFit, AFlightThatStaysOnTheGroundSaysNothing) {
  flight_log::FlightFolder flight = flown({}, 0.0, 1);
  for (auto& s : flight.samples) s.true_p_EB->z() = -0.1;
  EXPECT_FALSE(fit_drag(flight));
  EXPECT_FALSE(fit_drag(flight_log::FlightFolder{}));
  for (auto& s : flight.samples) s.true_p_EB.reset();
  EXPECT_FALSE(fit_drag(flight));
}

TEST(DragFit, TheMeanLeavesOutOneFlight) {
  std::vector<DragFit> fits(3);
  for (std::size_t i = 0; i < 3; ++i) fits[i].drag = {-0.5 - 0.1 * static_cast<double>(i), -0.4};
  EXPECT_NEAR(mean_of(fits).drag.x(), -0.6, 1e-12);
  EXPECT_NEAR(mean_of(fits, 0).drag.x(), -0.65, 1e-12);
  EXPECT_NEAR(mean_of(fits, 2).drag.x(), -0.55, 1e-12);
}

}  // namespace
}  // namespace gatefly::identification
