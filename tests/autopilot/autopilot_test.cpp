// SPDX-License-Identifier: Apache-2.0
// An autopilot between a pilot and its rotors: how late, how smooth, how fast, and by which curves.
#include "gatefly/sim/autopilot/autopilot.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/autopilot/companion.hpp"

namespace gatefly::sim {
namespace {

using Eigen::Vector3d;
using Takes = world::AutopilotTruth::Takes;

constexpr double kHz = 512.0, kDt = 1.0 / kHz;

world::AutopilotTruth holding(Takes takes) {
  world::AutopilotTruth truth;
  truth.takes = takes;
  return truth;
}

/// In free air, held in its place: it turns and feels its thrust, and goes nowhere.
struct Tethered {
  explicit Tethered(const world::AutopilotTruth& truth, const world::VehicleTruth& v = {})
      : vehicle{v}, autopilot{truth, v} {}

  void fly(const SetPoint& wanted) {
    const Imu imu{rate + gyro_bias, accel_B};
    const auto speeds = autopilot.step(wanted, imu, kDt);
    Vector3d torque = push;
    thrust = 0.0;
    constexpr std::array<double, 4> kX{1, 1, -1, -1}, kY{-1, 1, 1, -1}, kYaw{-1, 1, -1, 1};
    for (std::size_t i = 0; i < 4; ++i) {
      rotor[i] += kDt / vehicle.rotor_time_constant * (speeds[i] - rotor[i]);
      const double f = vehicle.thrust_coefficient * rotor[i] * rotor[i];
      torque += Vector3d{-kY[i] * vehicle.arm_y * f, kX[i] * vehicle.arm_x * f,
                         kYaw[i] * vehicle.torque_coefficient * f};
      thrust += f;
    }
    rate +=
        kDt *
        (torque - rate.cross(vehicle.inertia.cwiseProduct(rate))).cwiseQuotient(vehicle.inertia);
    q = integrated(q, rate, kDt);
    accel_B = rotation_EB(q).matrix.transpose() * (held_by - Vector3d{0, 0, kGravity});
  }

  world::VehicleTruth vehicle;
  Autopilot autopilot;
  Quaternion q;
  Vector3d rate = Vector3d::Zero(), gyro_bias = Vector3d::Zero(), push = Vector3d::Zero();
  Vector3d held_by = Vector3d::Zero();  ///< Acceleration of the place [m/s²].
  Vector3d accel_B{0, 0, -kGravity};
  std::array<double, 4> rotor{};
  double thrust = 0.0;
};

SetPoint hovering(const world::VehicleTruth& vehicle, msp::Sticks sticks = msp::kNeutral) {
  const double hover = std::sqrt(vehicle.mass * kGravity / 4.0 / vehicle.thrust_coefficient);
  sticks.throttle = static_cast<std::uint16_t>(
      StickCurves{{}}.throttle.stick(throttle_of(hover, vehicle.max_speed)));
  return {sticks, true};
}

TEST(Smoothing, IsThreeDecibelDownAtItsCutOff) {
  const auto gain = [](double hz) {
    Smoothing<1> low_pass{15.0};
    constexpr int kFast = 8000;
    double most = 0.0;
    for (int i = 0; i < 3 * kFast; ++i) {
      const Eigen::Matrix<double, 1, 1> x{std::sin(2 * kPi * hz * i / kFast)};
      const double y = low_pass.update(x, 1.0 / kFast)[0];
      if (i > kFast) most = std::max(most, std::abs(y));
    }
    return most;
  };
  EXPECT_NEAR(gain(0.5), 1.0, 0.01);
  EXPECT_NEAR(gain(15.0), std::sqrt(0.5), 0.01);
  EXPECT_LT(gain(60.0), 0.12);
}

TEST(Companion, SendsSoManyASecondEachLateByTheDelayAndInOrder) {
  world::AutopilotTruth truth = holding(Takes::kRates);
  truth.hz = 40.0, truth.delay = 0.030, truth.delay_jitter = 0.010;
  Companion line{truth, 1000.0, 7};
  int arrivals = 0, last = 1500;
  double least = 1e9, most = 0.0;
  // A wish that grows says when it was sent; sticks are as fine as 11 ms of that here.
  constexpr double kGrows = 0.7, kStick = 0.006;
  const msp::RateCurve roll = StickCurves{truth}.rates.roll;
  for (int i = 0; i < 768; ++i) {
    const double now = i / kHz;
    const SetPoint& s = line.pass_on({.rates_B = {kGrows * now, 0, 0}, .rotor_speed = 500.0}, now);
    if (s.sticks.roll == last) continue;
    ASSERT_GT(s.sticks.roll, last);
    last = s.sticks.roll, ++arrivals;
    const double late = now - roll.rate(s.sticks.roll) / kGrows;
    least = std::min(least, late), most = std::max(most, late);
  }
  EXPECT_NEAR(arrivals, 1.5 * truth.hz, 3);
  EXPECT_GT(least, 0.030 - kStick);
  EXPECT_LT(least, 0.030 + kStick + kDt);
  EXPECT_LT(most, 0.030 + 2.5 * 0.010 + kStick + kDt);
  EXPECT_GT(most, 0.040);
}

TEST(Companion, ASetPointHoldsUntilTheNextOneArrives) {
  world::AutopilotTruth truth = holding(Takes::kRates);
  truth.hz = 40.0, truth.delay = 0.020, truth.delay_jitter = 0.0;
  Companion line{truth, 1000.0, 7};
  int changes = 0;
  std::uint16_t before = 0;
  for (int i = 0; i < 512; ++i) {
    const double now = i / kHz;
    const SetPoint s =
        line.pass_on({.rates_B = {std::sin(30.0 * now), 0, 0}, .rotor_speed = 1}, now);
    EXPECT_EQ(s.armed, now >= 0.020 - 1e-9) << now;
    changes += s.sticks.roll != before;
    before = s.sticks.roll;
  }
  EXPECT_NEAR(changes, 39, 2);
}

TEST(Autopilot, HoldsTheRateThatTheCurveHasForTheStick) {
  // 200 · 0.55 · x / (1 − 0.75 x) °/s: half a stick is 88 °/s, not half of 440. [AI Grand Prix teams]
  for (const auto& [stick, degrees] : {std::pair{1750, 88.0}, std::pair{1300, -62.86}}) {
    Tethered drone{holding(Takes::kRates)};
    msp::Sticks sticks;
    sticks.roll = static_cast<std::uint16_t>(stick);
    const SetPoint wanted = hovering(drone.vehicle, sticks);
    for (int i = 0; i < 400; ++i) drone.fly(wanted);
    EXPECT_NEAR(drone.rate.x() / kDegree, degrees, 0.03 * std::abs(degrees)) << stick;
    EXPECT_NEAR(drone.rate.z(), 0.0, 0.05);
  }
}

TEST(Autopilot, ForwardStickIsNoseDownAndRightStickNoseRight) {
  Tethered drone{holding(Takes::kRates)};
  const SetPoint wanted = hovering(drone.vehicle, {.pitch = 1600, .yaw = 1600});
  for (int i = 0; i < 100; ++i) drone.fly(wanted);
  EXPECT_LT(drone.rate.y(), -0.3);
  EXPECT_GT(drone.rate.z(), 0.3);
}

TEST(Autopilot, ARateIsThereWithinAFewRotorLagsAndHardlyOvershoots) {
  for (const double tau : {0.020, 0.040}) {
    world::VehicleTruth vehicle;
    vehicle.rotor_time_constant = tau;
    Tethered drone{holding(Takes::kRates), vehicle};
    for (int i = 0; i < 100; ++i) drone.fly(hovering(vehicle));
    const SetPoint wanted = hovering(vehicle, {.roll = 1650});
    const double rate = StickCurves{{}}.rates.roll.rate(1650);
    double reached = 0.0, most = 0.0;
    for (int i = 0; i < 300; ++i) {
      drone.fly(wanted);
      if (reached == 0.0 && drone.rate.x() > 0.63 * rate) reached = i * kDt;
      most = std::max(most, drone.rate.x());
    }
    EXPECT_GT(reached, 0.02) << "what is smoothed at 15 Hz takes 20 ms";
    EXPECT_LT(reached, 0.03 + 2.0 * tau) << tau;
    EXPECT_LT(most, 1.2 * rate) << tau;
  }
}

TEST(Autopilot, HoldsItsRateAgainstAPushThatLasts) {
  Tethered drone{holding(Takes::kRates)};
  drone.push = {0.05, 0.03, 0.0};
  for (int i = 0; i < 1500; ++i) drone.fly(hovering(drone.vehicle));
  EXPECT_LT(drone.rate.norm(), 0.02);
}

TEST(Autopilot, HoldsAnglesWithWhatItFindsLevel) {
  Tethered drone{holding(Takes::kAngles)};
  drone.gyro_bias = {0.02, -0.01, 0.01};
  for (int i = 0; i < 500; ++i) drone.fly({});  // at rest it learns what its gyro says of nothing
  EXPECT_EQ(drone.rotor[0], 0.0);
  const int stick = StickCurves{{}}.angle_stick(15.0 * kDegree);
  drone.rate.setZero(), drone.q = {};
  for (int i = 0; i < 1024; ++i)
    drone.fly(hovering(drone.vehicle, {.pitch = std::uint16_t(stick)}));
  const Attitude attitude = attitude_of(rotation_EB(drone.q));
  EXPECT_NEAR(attitude.pitch / kDegree, -15.0, 1.0);
  EXPECT_NEAR(attitude.roll / kDegree, 0.0, 1.0);
}

TEST(Autopilot, ItsAnglesDriftWhereItAcceleratesForLong) {
  const auto error = [](double seconds) {
    Tethered drone{holding(Takes::kAngles)};
    drone.held_by = {3.0, 0.0, 0.0};
    for (int i = 0; i < static_cast<int>(seconds * kHz); ++i) drone.fly(hovering(drone.vehicle));
    return std::abs(attitude_of(rotation_EB(drone.q)).pitch) / kDegree;
  };
  EXPECT_LT(error(0.5), 4.0);
  EXPECT_GT(error(4.0), 8.0);  // of the 17 that gravity and acceleration together lean by
}

TEST(Autopilot, TheThrottleCurveGivesBackTheRotorSpeedThatWasMeant) {
  world::AutopilotTruth truth = holding(Takes::kRates);
  truth.delay = truth.delay_jitter = 0.0;
  Tethered drone{truth};
  for (const double speed : {400.0, 780.0, 1100.0}) {
    Companion line{truth, drone.vehicle.max_speed, 7};
    const SetPoint s = line.pass_on({.rotor_speed = speed}, 0.0);
    for (int i = 0; i < 300; ++i) drone.fly(s);
    for (const double w : drone.rotor) EXPECT_NEAR(w, speed, 0.01 * speed);
  }
}

TEST(Autopilot, RotorsStayWithinTheirLimitsWhateverIsAsked) {
  Tethered drone{holding(Takes::kRates)};
  const SetPoint wild{{.roll = 2000, .pitch = 1000, .yaw = 2000, .throttle = 2000}, true};
  for (int i = 0; i < 100; ++i)
    for (const double w : drone.autopilot.step(wild, {{std::nan(""), 0, 0}, {}}, kDt)) {
      EXPECT_GE(w, 0.0);
      EXPECT_LE(w, drone.vehicle.max_speed);
    }
}

TEST(Autopilot, StopsTheRotorsWhenDisarmed) {
  Tethered drone{holding(Takes::kRates)};
  for (int i = 0; i < 50; ++i) drone.fly(hovering(drone.vehicle));
  for (const double w : drone.autopilot.step({}, {}, kDt)) EXPECT_EQ(w, 0.0);
}

}  // namespace
}  // namespace gatefly::sim
