// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/forces.hpp"

#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/sim/gusts.hpp"

namespace gatefly::sim {
namespace {

constexpr double kForceStep = 1.0 / 1024;

// R = 0.1, d = 0.4, z = 0.2: 1 / (1 - 0.015625 - 0.011049 - 0.003007 - 0.024056).
TEST(GroundEffect, GrowsTowardsTheFloorAndIsNothingHighAbove) {
  EXPECT_NEAR(ground_effect(10.0, 0.065, 0.19), 1.0, 5e-5);
  EXPECT_NEAR(ground_effect(0.2, 0.1, 0.4), 1.05679, 1e-5);
  double last = 1.0;
  for (double z = 2.0; z > 0.03; z *= 0.9) {
    const double ratio = ground_effect(z, 0.065, 0.19);
    EXPECT_GT(ratio, last) << z;
    last = ratio;
  }
  EXPECT_LT(last, 1.6);
  EXPECT_EQ(ground_effect(0.0, 0.065, 0.19), ground_effect(0.01, 0.065, 0.19));  // on its feet
}

// Flown forward the air pitches the nose up, flown to the right it rolls left; standing air, no moment.
TEST(AirMoment, TurnsTheBodyBackFromWhereItGoes) {
  world::SimConfig config;
  config.vehicle.air_moment = {0.01, 0.03};
  const double hover =
      std::sqrt(config.vehicle.mass * kGravity / 4 / config.vehicle.thrust_coefficient);
  const auto torque = [&](const Eigen::Vector3d& v_E, const Eigen::Vector2d& wind) {
    config.wind.mean = wind;
    Forces forces{config};
    BodyState state;
    state.p_EB.z() = -5.0;
    state.v_E = v_E;
    for (int i = 0; i < 1024; ++i)  // until the rotors turn as fast as they should
      forces.advance({hover, hover, hover, hover}, state, i * kForceStep, kForceStep);
    return Eigen::Vector3d{forces.torque_B()};
  };
  EXPECT_LT((torque({2, 0, 0}, {0, 0}) - Eigen::Vector3d{0, 0.06, 0}).norm(), 1e-9);
  EXPECT_LT((torque({0, 2, 0}, {0, 0}) - Eigen::Vector3d{-0.02, 0, 0}).norm(), 1e-9);
  EXPECT_LT(torque({2, 1, 0}, {2, 1}).norm(), 1e-9);
}

/// Gusts of one axis, sampled every `every` steps, for so many seconds.
std::vector<Eigen::Vector3d> recorded(const world::Wind& wind, double airspeed, double seconds,
                                      int every) {
  Gusts gusts{wind, 7};
  std::vector<Eigen::Vector3d> record;
  for (int i = 0; i < static_cast<int>(seconds / kForceStep); ++i) {
    gusts.advance(airspeed, kForceStep);
    if (i % every == 0) record.push_back(gusts.velocity_E());
  }
  return record;
}

TEST(Gusts, HaveTheVarianceThatWasAskedForAlongTheWindAcrossAndUp) {
  const world::Wind wind{
      .mean = {0.0, 2.0}, .gust = 0.8, .gust_length = 0.5, .gust_vertical = 0.25};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = mean;
  const auto record = recorded(wind, 2.0, 2000.0, 64);
  for (const auto& v : record) mean += v, square += v.cwiseAbs2();
  mean /= static_cast<double>(record.size()), square /= static_cast<double>(record.size());
  // 8,000 correlation times: a standard deviation within 2 %.
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = axis < 2 ? 0.8 : 0.2;
    EXPECT_NEAR(mean(axis), 0.0, 0.07 * sigma);
    EXPECT_NEAR(std::sqrt(square(axis)), sigma, 0.05 * sigma) << axis;
  }
}

/// Mean power near a frequency: of many pieces of the record.
double power_at(const std::vector<double>& x, double omega, double dt, std::size_t piece) {
  double sum = 0.0;
  std::size_t pieces = 0;
  for (std::size_t begin = 0; begin + piece <= x.size(); begin += piece, ++pieces) {
    std::complex<double> z{0.0, 0.0};
    for (std::size_t i = 0; i < piece; ++i) {
      const double window =
          1.0 - std::cos(6.283185307179586 * static_cast<double>(i) / static_cast<double>(piece));
      z += window * x[begin + i] * std::polar(1.0, -omega * dt * static_cast<double>(i));
    }
    sum += std::norm(z);
  }
  return sum / static_cast<double>(pieces);
}

// MIL-F-8785C: along 1 / (1 + a²), across (1 + 3 a²) / (1 + a²)², a = Lω/V.
TEST(Gusts, HaveDrydensSpectrum) {
  const world::Wind wind{.mean = {1.0, 0.0}, .gust = 1.0, .gust_length = 1.0};
  constexpr int kEvery = 16;
  const double dt = kEvery * kForceStep;
  std::vector<double> along, across;
  for (const auto& v : recorded(wind, 2.0, 4000.0, kEvery))
    along.push_back(v.x()), across.push_back(v.y());
  const auto form_along = [](double a) { return 1.0 / (1.0 + a * a); };
  const auto form_across = [](double a) { return (1 + 3 * a * a) / ((1 + a * a) * (1 + a * a)); };
  const double low = 1.0;  // a = 0.5
  for (const double omega : {2.0, 6.0, 16.0}) {
    const auto ratio = [&](const std::vector<double>& x) {
      return power_at(x, omega, dt, 2048) / power_at(x, low, dt, 2048);
    };
    EXPECT_NEAR(ratio(along) / (form_along(omega / 2) / form_along(low / 2)), 1.0, 0.3) << omega;
    EXPECT_NEAR(ratio(across) / (form_across(omega / 2) / form_across(low / 2)), 1.0, 0.3) << omega;
  }
}

TEST(Gusts, WithoutGustsTheAirStandsStill) {
  EXPECT_EQ(recorded({.mean = {1.0, 0.0}}, 2.0, 1.0, 1).back(), Eigen::Vector3d::Zero());
}

/// Thrust [N] of rotors that turn at `speed` and have done so for `seconds`, high above the floor.
class Rig {
 public:
  explicit Rig(const world::SimConfig& config) : forces_{config} { state_.p_EB.z() = -100.0; }
  double run(double speed, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kForceStep); ++i, time_ += kForceStep)
      forces_.advance({speed, speed, speed, speed}, state_, time_, kForceStep);
    return -forces_.force_B(Eigen::Matrix3d::Identity(), forces_.wind_E()).z();
  }
  [[nodiscard]] const Forces& forces() const { return forces_; }
  BodyState state_;

 private:
  Forces forces_;
  double time_ = 0.0;
};

double speed_at_hover(const world::VehicleTruth& v) {
  return std::sqrt(v.mass * kGravity / 4 / v.thrust_coefficient);
}

TEST(Battery, HoveringForSagTimeCostsTheSagAndLoadCostsMoreUntilItIsGone) {
  world::SimConfig config;
  config.vehicle.sag = 0.10, config.vehicle.sag_time = 60.0;
  const double hover = speed_at_hover(config.vehicle), weight = config.vehicle.mass * kGravity;
  Rig rig{config};
  EXPECT_NEAR(rig.run(hover, 0.2), weight, 2e-3 * weight);
  EXPECT_NEAR(rig.run(hover, 59.8), 0.90 * weight, 2e-3 * weight);
  const double voltage = rig.forces().voltage();
  const double full = rig.run(1.2 * hover, 0.5) / (1.44 * weight);
  EXPECT_LT(rig.forces().voltage(), voltage - 0.1);
  EXPECT_LT(full, 0.885);
  EXPECT_NEAR(rig.run(hover, 0.5), 0.90 * weight, 4e-3 * weight);  // it recovers
}

TEST(Faults, LostThrustIsLostWhenAndWhereItIsSaid) {
  world::SimConfig config;
  config.faults = {.thrust_loss = 0.3, .weak_rotor = 0, .thrust_loss_during = {1.0, 1.0}};
  const double hover = speed_at_hover(config.vehicle), weight = config.vehicle.mass * kGravity;
  Rig all{config};
  EXPECT_NEAR(all.run(hover, 0.9), weight, 1e-3 * weight);
  EXPECT_NEAR(all.run(hover, 0.5), 0.7 * weight, 1e-3 * weight);
  EXPECT_NEAR(all.run(hover, 0.9), weight, 1e-3 * weight);

  config.faults.weak_rotor = 1;  // front left: it rolls to the left and pitches forward
  Rig one{config};
  EXPECT_NEAR(one.run(hover, 1.5), (1.0 - 0.3 / 4) * weight, 1e-3 * weight);
  EXPECT_LT(one.forces().torque_B().x(), -0.01);
  EXPECT_LT(one.forces().torque_B().y(), -0.01);
}

TEST(Faults, WindBlowsWhenItIsSaid) {
  world::SimConfig config;
  config.wind.mean = {0.2, 0.0};
  config.faults = {.wind = {3.0, -1.0}, .wind_during = {1.0, 0.5}};
  Rig rig{config};
  rig.run(700.0, 0.9);
  EXPECT_EQ(rig.forces().wind_E(), Eigen::Vector3d(0.2, 0.0, 0.0));
  rig.run(700.0, 0.3);
  EXPECT_EQ(rig.forces().wind_E(), Eigen::Vector3d(3.2, -1.0, 0.0));
  rig.run(700.0, 0.5);
  EXPECT_EQ(rig.forces().wind_E(), Eigen::Vector3d(0.2, 0.0, 0.0));
}

}  // namespace
}  // namespace gatefly::sim
