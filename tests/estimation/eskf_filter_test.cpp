// SPDX-License-Identifier: Apache-2.0
// The error-state filter as a whole, against flights of its own kind: drag, wind, biases, a camera that is
// told wrong, a map that is off, all drawn from what it believes before take-off.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/estimation/eskf/correction.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly::eskf {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::IsCovariance;
using test::IsNear;
using test::normal;

constexpr double kHz = 512.0, kTick = 1.0 / kHz;

eskf::Setup setup_for(std::size_t gates = 1) {
  eskf::Setup setup;
  for (std::size_t i = 0; i < gates; ++i)
    setup.map.push_back({{5.0, 6.0 * static_cast<double>(i), -1.5}, 0.0, {1.0, 0.05}});
  setup.R_BC = camera_mount(0.3).matrix;
  setup.camera = {{0.1, 0, 0}, 0.006};
  // White corners: what the flight below draws.
  setup.params.sight = {
      .own = 0.7, .together = 0.0, .size = 0.0, .lasting = 0.01, .lasting_size = 0.01};
  // The flight below shakes as its own noise does.
  Noise& noise = setup.params.noise;
  noise.shaking = {2.0 * noise.drag_measurement + noise.accel_z, 3.0 * noise.attitude};
  noise.gust_adaptation = 0.0;
  setup.params.priors.gust = 0.2;
  return setup;
}

Vector3d drawn(Rng& rng, const Vector3d& sigma) {
  return {sigma.x() * normal(rng), sigma.y() * normal(rng), sigma.z() * normal(rng)};
}

// A drone that hovers to and fro before a gate; everything the filter does not know is drawn from what it
// believes.
class Flight {
 public:
  Flight(const eskf::Setup& setup, std::uint64_t seed) : setup_{setup}, rng_{seed}, filter{setup} {
    const Priors& p = setup.params.priors;
    truth.p_EB = drawn(rng_, p.position);
    truth.v_E = drawn(rng_, Vector3d::Constant(p.speed));
    truth.R_EB = rotation_of(drawn(rng_, {p.tilt, p.tilt, p.heading}));
    truth.accel_bias = drawn(rng_, p.accel_bias);
    truth.gyro_bias = drawn(rng_, Vector3d::Constant(p.gyro_bias));
    truth.wind = {p.wind * normal(rng_), p.wind * normal(rng_)};
    truth.gust = {p.gust * normal(rng_), p.gust * normal(rng_)};
    truth.drag = {p.drag * normal(rng_), p.drag * normal(rng_)};
    truth.R_BC = setup.R_BC * rotation_of(drawn(rng_, p.mount));
    truth.focal = p.focal * normal(rng_), truth.bend = p.bend * normal(rng_);
    truth.delay = p.delay * normal(rng_), truth.thrust = p.thrust * normal(rng_);
    for (std::size_t i = 0; i < setup.map.size(); ++i)
      truth.gates[i] = {setup.map[i].p_EG + drawn(rng_, {p.map, p.map, p.map_height}),
                        setup.map[i].yaw_EG + p.map_yaw * normal(rng_), p.map_size * normal(rng_)};
    const Vector3d rest = truth.R_EB.transpose() * Vector3d{0, 0, -setup.params.gravity} +
                          truth.accel_bias + drawn(rng_, Vector3d::Constant(p.rest_accel));
    // The rest turns with it: attitude is given from here on.
    tilted_ = truth.R_EB;
    filter.start({.rest_accel_B = rest}, 0.0);
  }

  void step() {
    t += kTick;
    move();
    filter.predict(imu_, kTick, t, thrust_);
    history_.push_back({t, truth});
    if (++ticks_ % 26 == 0) filter.correct_height(-truth.p_EB.z() + 0.04 * normal(rng_), 0.04);
    if (ticks_ % 34 == 0) see();
  }

  /// Squared error of p, v and θ in units of their covariance.
  [[nodiscard]] double nees() const {
    const Nominal& x = filter.now();
    Eigen::Matrix<double, 9, 1> e;
    e << truth.p_EB - x.p_EB, truth.v_E - x.v_E, turn_of(truth.R_EB * x.R_EB.transpose());
    const Eigen::Matrix<double, 9, 9> P = filter.covariance().topLeftCorner<9, 9>();
    return e.dot(P.ldlt().solve(e));
  }

  double t = 0.0;
  Nominal truth;

 private:
  void move() {
    const Params& params = setup_.params;
    const Noise& noise = params.noise;
    const Vector3d goal{1.5 * std::sin(0.5 * t), 1.2 * std::sin(0.31 * t + 1.0),
                        -1.5 + 0.3 * std::sin(0.23 * t)};
    const Vector3d wanted = 1.0 * (goal - truth.p_EB) - 1.5 * truth.v_E;
    const double follow = kTick / 0.15;
    pitch_ += follow * (-0.1 * wanted.x() - pitch_), roll_ += follow * (0.1 * wanted.y() - roll_);
    const Eigen::Matrix3d R = tilted_ * rotation_z(0.3 * std::sin(0.4 * t)) *
                              rotation_EB(Attitude{roll_, pitch_, 0.0}).matrix;
    const Vector3d turn = turn_of(truth.R_EB.transpose() * R);
    const Eigen::Matrix3d middle = truth.R_EB * rotation_of(0.5 * turn);
    const double left = gust_left(truth, kTick, params);
    const double push = params.priors.gust * std::sqrt(1.0 - left * left);
    truth.gust = left * truth.gust + push * Vector2d{normal(rng_), normal(rng_)};
    truth.wind += std::sqrt(noise.wind * kTick) * Vector2d{normal(rng_), normal(rng_)};
    Vector3d air = truth.v_E;
    air.head<2>() -= truth.wind + truth.gust;
    const Vector3d air_B = middle.transpose() * air;
    // Rotors are told so much, and give more or less than that, and not quite.
    thrust_ = (params.gravity - wanted.z()) / (1.0 + truth.thrust);
    Vector3d force{0, 0,
                   -(1.0 + truth.thrust) * thrust_ +
                       std::sqrt((noise.thrust_measurement - noise.accel_z) * kHz) * normal(rng_)};
    for (int i = 0; i < 2; ++i)  // what drag leaves out moves the drone, too
      force(i) = params.drag(i) * (1 + truth.drag(i)) * air_B(i) +
                 std::sqrt((noise.drag_measurement - noise.accel) * kHz) * normal(rng_);
    const Vector3d a = middle * force + Vector3d{0, 0, params.gravity};
    truth.p_EB += kTick * truth.v_E + 0.5 * kTick * kTick * a;
    truth.v_E += kTick * a;
    truth.R_EB = R;
    truth.rate_B = turn * kHz;
    imu_.gyro_B = truth.rate_B + truth.gyro_bias +
                  std::sqrt(noise.attitude * kHz) * drawn(rng_, Vector3d::Ones());
    imu_.accel_B = force + truth.accel_bias +
                   std::sqrt(kHz) * drawn(rng_, {std::sqrt(noise.accel), std::sqrt(noise.accel),
                                                 std::sqrt(noise.accel_z)});
  }

  // A picture of 60 ms ago, or of when the delay says.
  void see() {
    const double told = t - 0.060, at = told + truth.delay;
    if (history_.size() < 60) return;
    const auto then = std::min_element(history_.end() - 60, history_.end(), [&](auto& a, auto& b) {
      return std::abs(a.first - at) < std::abs(b.first - at);
    });
    Nominal x = then->second;
    const double rest = at - then->first;
    x.p_EB += rest * x.v_E, x.R_EB = x.R_EB * rotation_of(rest * x.rate_B);
    GateSight sight{.time = told, .jitter = 0.001, .features = {}};
    const auto corners = gate_corners_G(1.0 + x.gates[0].size);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3d p_E = x.gates[0].p_EG + rotation_z(x.gates[0].yaw_EG) * corners[i];
      const Vector3d c =
          x.R_BC.transpose() * (x.R_EB.transpose() * (p_E - x.p_EB) - setup_.camera.p_BC);
      if (c.z() < 0.3) return;
      const double slope2 = c.head<2>().squaredNorm() / (c.z() * c.z());
      const double a = 1.0 + x.focal + x.bend * slope2;
      Vector3d u = Vector3d{a * c.x(), a * c.y(), c.z()}.normalized();
      const Vector3d right = Vector3d::UnitY().cross(u).normalized();
      const double px = setup_.camera.radians_per_px * setup_.params.sight.own;
      u = (u + px * normal(rng_) * right + px * normal(rng_) * u.cross(right)).normalized();
      (void)sight.features.push_back({.which = static_cast<std::uint8_t>(i), .bearing_C = u});
    }
    EXPECT_TRUE(filter.correct({&sight, 1}));
    EXPECT_TRUE(filter.innovation_of(sight).has_value());
  }

  eskf::Setup setup_;
  Rng rng_;
  Eigen::Matrix3d tilted_;
  double roll_ = 0.0, pitch_ = 0.0, thrust_ = 0.0;
  long ticks_ = 0;
  Imu imu_;
  std::vector<std::pair<double, Nominal>> history_;

 public:
  ErrorStateFilter filter;
};

// 30 flights, 9 degrees of freedom, after 5 and 15 s: the mean of 270 squared normal numbers is within
// 0.68 and 1.36 with a probability of 99.99 %; a little more is left for what is not linear.
TEST(ErrorStateFilter, KnowsHowWrongItIsInFlightsOfItsOwnKind) {
  constexpr int kFlights = 30;
  std::array<double, 2> sum{};
  for (int flight = 0; flight < kFlights; ++flight) {
    Flight one{setup_for(), 1000 + static_cast<std::uint64_t>(flight)};
    for (std::size_t i = 0; i < 2; ++i) {
      while (one.t < (i == 0 ? 5.0 : 15.0)) one.step();
      sum[i] += one.nees() / (9.0 * kFlights);
    }
    EXPECT_THAT(one.filter.covariance(), IsCovariance());
  }
  for (const double mean : sum) {
    EXPECT_GT(mean, 0.65);
    EXPECT_LT(mean, 1.45);
  }
}

TEST(ErrorStateFilter, FindsWindMountThrustAndBiasFromOrdinaryFlying) {
  double wind = 0.0, tilt = 0.0, bias = 0.0, thrust = 0.0, thrust_nees = 0.0;
  constexpr int kFlights = 12;
  const Priors priors = setup_for().params.priors;
  for (int flight = 0; flight < kFlights; ++flight) {
    Flight one{setup_for(), 2000 + static_cast<std::uint64_t>(flight)};
    while (one.t < 20.0) one.step();
    const Nominal& x = one.filter.now();
    wind += (x.wind - one.truth.wind).squaredNorm() / (2 * kFlights);
    tilt += std::pow(turn_of(x.R_BC.transpose() * one.truth.R_BC).x(), 2) / kFlights;
    const double off = x.thrust - one.truth.thrust;
    thrust += off * off / kFlights;
    thrust_nees += std::pow(off / one.filter.sigma(kThrust), 2) / kFlights;
    bias += (x.accel_bias - one.truth.accel_bias).head<2>().squaredNorm() / (2 * kFlights);
  }
  EXPECT_LT(std::sqrt(wind), 0.5 * priors.wind);
  EXPECT_LT(std::sqrt(tilt), 0.5 * priors.mount.x());
  EXPECT_LT(std::sqrt(bias), 0.3 * priors.accel_bias.x());
  EXPECT_LT(std::sqrt(thrust), 0.01);
  // The mean of 12 squared normal numbers: within .15 and 2.7 with a probability of 99.9 %.
  EXPECT_GT(thrust_nees, 0.15);
  EXPECT_LT(thrust_nees, 2.7);
}

TEST(ErrorStateFilter, AFixWithoutDelayIsTheSameThroughTheRingAsAtOnce) {
  const eskf::Setup setup = setup_for();
  Flight flight{setup, 5};
  while (flight.t < 2.0) flight.step();
  ErrorStateFilter filter = flight.filter;
  // The newest tick ends at the last multiple of four samples.
  const double at = std::floor(flight.t * 128.0 + 1e-6) / 128.0;
  GateSight sight{.time = at, .features = {}};
  Nominal x = filter.now();
  const auto corners = gate_corners_G(1.0);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d c =
        x.R_BC.transpose() *
        (x.R_EB.transpose() * (x.gates[0].p_EG + corners[i] - x.p_EB) - setup.camera.p_BC);
    (void)sight.features.push_back(
        {.which = static_cast<std::uint8_t>(i),
         .bearing_C = (c.normalized() + Vector3d{0.004, -0.002, 0.0}).normalized()});
  }
  Covariance P = filter.covariance();
  ASSERT_TRUE(
      correct_by_gate(x, P, sight, setup.map[0].shape, 0.0, setup.camera, setup.params.sight));
  ASSERT_TRUE(filter.correct({&sight, 1}));
  EXPECT_THAT(filter.now().p_EB, IsNear(x.p_EB, 1e-9));
  EXPECT_THAT(filter.now().v_E, IsNear(x.v_E, 1e-9));
  EXPECT_THAT(filter.covariance(), IsNear(P, 1e-12));
}

// As motion capture gives it, where no gate is on the map at all.
TEST(ErrorStateFilter, APositionIsTakenInAndStays) {
  eskf::Setup setup = setup_for(0);
  ErrorStateFilter filter{setup};
  EXPECT_FALSE(filter.correct_position(Vector3d::Zero(), Vector3d::Ones())) << "has not started";
  filter.start({}, 0.0);
  const Imu still{.gyro_B = Vector3d::Zero(), .accel_B = {0, 0, -setup.params.gravity}};
  const Vector3d place{0.2, -0.1, -0.05};
  double t = 0.0;
  for (int i = 0; i < 64; ++i) filter.predict(still, kTick, t += kTick);
  EXPECT_TRUE(filter.correct_position(place, Vector3d::Constant(0.01)));
  EXPECT_THAT(filter.covariance(), IsCovariance());
  EXPECT_LT((filter.now().p_EB - place).norm(), 0.03);
  EXPECT_LT(filter.sigma(kP), 0.0101);
  const Vector3d before = filter.now().p_EB;
  EXPECT_FALSE(filter.correct_position(Vector3d::Constant(std::nan("")), Vector3d::Ones()));
  EXPECT_FALSE(filter.correct_position(place, Vector3d::Zero()));
  EXPECT_EQ(filter.now().p_EB, before);
}

TEST(ErrorStateFilter, RefusesAPictureThatIsOlderThanItRemembers) {
  Flight flight{setup_for(), 7};
  while (flight.t < 2.0) flight.step();
  GateSight sight{.time = flight.t - 0.5, .features = {}};
  (void)sight.features.push_back({});
  EXPECT_FALSE(flight.filter.innovation_of(sight).has_value());
  EXPECT_FALSE(flight.filter.correct({&sight, 1}));
  sight.time = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(flight.filter.correct({&sight, 1}));
}

TEST(ErrorStateFilter, WhatIsNoNumberChangesNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Flight flight{setup_for(), 8};
  while (flight.t < 2.0) flight.step();
  ErrorStateFilter& filter = flight.filter;
  GateSight sight{.time = flight.t - 0.06, .features = {}};
  (void)sight.features.push_back({.bearing_C = Vector3d::Constant(kNan)});
  EXPECT_FALSE(filter.innovation_of(sight).has_value());
  (void)filter.correct({&sight, 1});
  EXPECT_FALSE(filter.correct_height(kNan, 0.04));
  filter.predict({}, kNan, flight.t);
  EXPECT_TRUE(filter.now().p_EB.allFinite());
  EXPECT_THAT(filter.covariance(), IsCovariance());
}

// Twelve gates, eight at a time: what was found of one is kept while it has no slot.
TEST(Landmarks, KeepWhatWasFoundOfAGateThatHasLostItsSlot) {
  const eskf::Setup setup = setup_for(12);
  Landmarks landmarks{setup.map, setup.params.priors};
  Nominal x;
  Covariance P = Eigen::MatrixXd::Identity(kMaxStates, kMaxStates);
  landmarks.reset(x, P);
  EXPECT_EQ(landmarks.slots(), 8);
  ASSERT_EQ(landmarks.slot_of(0), 0);
  x.gates[0].p_EG.x() = 5.4, P(gate_at(0), gate_at(0)) = 0.0009;
  for (std::size_t target = 0; target < 6; ++target) (void)landmarks.bring_in(target, x, P);
  EXPECT_EQ(landmarks.slot_of(0), -1);
  for (std::size_t target = 6; target < 12; ++target) {
    (void)landmarks.bring_in(target, x, P);
    ASSERT_GE(landmarks.slot_of(target), 0);
  }
  const int slot = landmarks.slot_of(0);
  ASSERT_GE(slot, 0);
  EXPECT_EQ(x.gates[static_cast<std::size_t>(slot)].p_EG.x(), 5.4);
  EXPECT_NEAR(P(gate_at(slot), gate_at(slot)), 0.0009, 1e-9);
}

// A course that comes by itself again: gate 1 stands beside gate 8, and shows beside it.
TEST(Landmarks, AGateThatStandsBesideTheTargetHasASlot) {
  eskf::Setup setup = setup_for(12);
  setup.map[0].p_EG = setup.map[7].p_EG + Vector3d{1.5, 1.0, 0.0};
  Landmarks landmarks{setup.map, setup.params.priors};
  Nominal x;
  Covariance P = Eigen::MatrixXd::Identity(kMaxStates, kMaxStates);
  landmarks.reset(x, P);
  for (std::size_t target = 0; target < 12; ++target) {
    (void)landmarks.bring_in(target, x, P);
    EXPECT_TRUE(target != 7 || landmarks.slot_of(0) >= 0);
    for (const std::size_t near : {target + 10, target + 11, target, target + 1, target + 2})
      EXPECT_GE(landmarks.slot_of(near % 12), 0) << near % 12 << " of target " << target;
  }
}

TEST(Landmarks, AGateThatTheMapHasTwiceIsOne) {
  std::vector<Landmark> map{
      {{5, 0, -1.5}, 0.1, {}}, {{0, 5, -1.5}, 1.0, {}}, {{5, 0, -1.5}, 0.1 + kPi, {}}};
  const Landmarks landmarks{map, {}};
  EXPECT_EQ(landmarks.size(), 2u);
  const auto back = landmarks.face_of({5, 0, -1.5}, 0.1 + kPi);
  EXPECT_EQ(back.landmark, 0u);
  EXPECT_TRUE(back.behind);
}

}  // namespace
}  // namespace gatefly::eskf
