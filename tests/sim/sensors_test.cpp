// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/solids.hpp"

#include "support/matchers.hpp"

namespace gatefly::sim {
namespace {

using test::IsNear;

constexpr double kDt = 1.0 / 512.0;
constexpr double kReference = 750.0;  // rotor speed at which vibration is what SensorTruth says

BodyState at_rotor_speed(double speed) {
  BodyState state;
  state.rotor_speed.fill(speed);
  return state;
}

/// An IMU without any error; tests put in the one they ask about.
world::SensorTruth perfect() {
  world::SensorTruth truth;
  truth.accel_bias.setZero(), truth.flight_bias.setZero();
  truth.gyro_bias.setZero(), truth.gyro_drift.setZero();
  truth.accel_noise.setZero(), truth.accel_vibration.setZero();
  truth.gyro_noise.setZero(), truth.gyro_vibration.setZero(), truth.gyro_rumble.setZero();
  return truth;
}

struct Statistics {
  Eigen::Vector3d mean, rms;  ///< RMS about the mean.
};

struct ImuStatistics {
  Statistics accel, gyro;
};

Statistics of(const std::vector<Eigen::Vector3d>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), sum2 = sum;
  for (const auto& x : samples) sum += x;
  const Eigen::Vector3d mean = sum / static_cast<double>(samples.size());
  for (const auto& x : samples) sum2 += (x - mean).cwiseAbs2();
  return {mean, (sum2 / static_cast<double>(samples.size())).cwiseSqrt()};
}

ImuStatistics measured(const world::SensorTruth& truth, const BodyState& state, int samples) {
  ImuModel model{truth, 3};
  std::vector<Eigen::Vector3d> accel, gyro;
  for (int i = 0; i < samples; ++i) {
    const Imu imu = model.measure(state, kDt);
    accel.push_back(imu.accel_B), gyro.push_back(imu.gyro_B);
  }
  return {of(accel), of(gyro)};
}

constexpr int kSamples = 20'000;
// Four standard errors of a mean of white noise, and of its standard deviation, as parts of it.
const double kOfMean = 4.0 / std::sqrt(kSamples), kOfNoise = 4.0 / std::sqrt(2.0 * kSamples);
constexpr double kAccelStep = 1.0 / 1024, kGyroStep = 1.0 / 4096;

TEST(ImuModel, WithoutErrorsMeasuresTheMotionToItsResolution) {
  BodyState state = at_rotor_speed(kReference);
  state.specific_force_B = {1.2345678, -2.3456789, -9.8765432};
  state.rate_B = {0.1234567, -0.2345678, 0.3456789};
  ImuModel model{perfect(), 1};
  const Imu imu = model.measure(state, kDt);
  EXPECT_THAT(imu.accel_B, IsNear(state.specific_force_B, 0.5 * kAccelStep));
  EXPECT_THAT(imu.gyro_B, IsNear(state.rate_B, 0.5 * kGyroStep));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(imu.accel_B[i], std::round(imu.accel_B[i] / kAccelStep) * kAccelStep);
    EXPECT_EQ(imu.gyro_B[i], std::round(imu.gyro_B[i] / kGyroStep) * kGyroStep);
  }
}

TEST(ImuModel, StopsAtTheEndOfItsRange) {
  BodyState state;
  state.specific_force_B = {1000, -1000, 0};
  state.rate_B = {-100, 100, 0};
  ImuModel model{perfect(), 1};
  const Imu imu = model.measure(state, kDt);
  EXPECT_THAT(imu.accel_B, IsNear(Eigen::Vector3d{78, -78, 0}, kAccelStep));
  EXPECT_THAT(imu.gyro_B, IsNear(Eigen::Vector3d{-17.4, 17.4, 0}, kGyroStep));
}

TEST(ImuModel, AtRestHasItsBiasesLittleNoiseAndNoVibration) {
  world::SensorTruth truth;  // with vibration
  truth.flight_bias = {1, 1, 1}, truth.gyro_drift = {1, 1, 1};
  const BodyState state = at_rotor_speed(0.0);
  const auto [accel, gyro] = measured(truth, state, kSamples);
  const Eigen::Vector3d accel_noise = 0.15 * truth.accel_noise,
                        gyro_noise = 0.15 * truth.gyro_noise;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(accel.mean[i], state.specific_force_B[i] + truth.accel_bias[i],
                kOfMean * accel_noise[i]);
    EXPECT_NEAR(gyro.mean[i], truth.gyro_bias[i], kOfMean * gyro_noise[i]);
    EXPECT_NEAR(accel.rms[i], accel_noise[i], kOfNoise * accel_noise[i]);
    EXPECT_NEAR(gyro.rms[i], gyro_noise[i], kOfNoise * gyro_noise[i]);
  }
}

TEST(ImuModel, InFlightTheNoiseIsWholeAndWhatAppearsAfterTakeOffIsThere) {
  world::SensorTruth truth;
  truth.accel_vibration.setZero(), truth.gyro_vibration.setZero(), truth.gyro_rumble.setZero();
  truth.flight_bias = {0.05, -0.02, 0.1}, truth.gyro_drift = {0.003, 0.002, -0.004};
  const BodyState state = at_rotor_speed(kReference);
  const auto [accel, gyro] = measured(truth, state, kSamples);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(accel.mean[i],
                state.specific_force_B[i] + truth.accel_bias[i] + truth.flight_bias[i],
                kOfMean * truth.accel_noise[i]);
    EXPECT_NEAR(gyro.mean[i], truth.gyro_bias[i] + truth.gyro_drift[i],
                kOfMean * truth.gyro_noise[i]);
    EXPECT_NEAR(accel.rms[i], truth.accel_noise[i], kOfNoise * truth.accel_noise[i]);
    EXPECT_NEAR(gyro.rms[i], truth.gyro_noise[i], kOfNoise * truth.gyro_noise[i]);
  }
}

TEST(ImuModel, NoiseIsWhiteAndItsAxesAreIndependent) {
  world::SensorTruth truth = perfect();
  truth.accel_noise = {1, 1, 1}, truth.gyro_noise = {1, 1, 1};
  ImuModel model{truth, 4};
  const BodyState state = [] {
    BodyState s = at_rotor_speed(kReference);
    s.specific_force_B.setZero();
    return s;
  }();
  using Six = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, 6, 6> together = Eigen::Matrix<double, 6, 6>::Zero(), in_turn = together;
  Six last = Six::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Imu imu = model.measure(state, kDt);
    Six now;
    now << imu.accel_B, imu.gyro_B;
    together += now * now.transpose() / kSamples;
    in_turn += now * last.transpose() / kSamples;
    last = now;
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(together(i, j), i == j ? 1.0 : 0.0, 1.5 * kOfMean) << i << j;
      EXPECT_NEAR(in_turn(i, j), 0.0, kOfMean) << i << j;
    }
}

TEST(ImuModel, ScaleErrorsScaleTheMotionNotTheBias) {
  world::SensorTruth truth = perfect();
  truth.accel_scale = {1.01, 0.98, 1.03}, truth.gyro_scale = {0.97, 1.02, 1.01};
  truth.accel_bias = {0.5, 0.5, 0.5}, truth.gyro_bias = {0.25, 0.25, 0.25};
  BodyState state;
  state.specific_force_B = {2, 4, -10};
  state.rate_B = {1, 2, -3};
  ImuModel model{truth, 1};
  const Imu imu = model.measure(state, kDt);
  EXPECT_THAT(imu.accel_B, IsNear(Eigen::Vector3d{2.52, 4.42, -9.8}, 0.51 * kAccelStep));
  EXPECT_THAT(imu.gyro_B, IsNear(Eigen::Vector3d{1.22, 2.29, -2.78}, 0.51 * kGyroStep));
}

// The sine's phase wanders by 0.3 rad a sample, so that about 20 samples count as one: 5 % are four
// standard errors of the RMS of 40,000.
TEST(ImuModel, VibrationGoesWithTheSquareOfRotorSpeed) {
  world::SensorTruth truth = perfect();
  truth.accel_vibration = {1.7, 0.6, 3.4}, truth.gyro_vibration = {0.12, 0.11, 0.18};
  for (const double speed : {500.0, kReference, 850.0, 1200.0}) {
    // Rotors faster than about 920 rad/s shake no harder.
    const double strength = std::min(1.5, speed * speed / (kReference * kReference));
    const auto [accel, gyro] = measured(truth, at_rotor_speed(speed), 40'000);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(accel.rms[i] / truth.accel_vibration[i], strength, 0.05 * strength) << speed;
      EXPECT_NEAR(gyro.rms[i] / truth.gyro_vibration[i], strength, 0.05 * strength) << speed;
    }
  }
}

// White noise of unit variance through a low-pass at 12 Hz and a high-pass at 3 Hz has a variance of
// 12 / (12 + 3). Without a mean: an angle that is summed up from it stays where it is.
TEST(ImuModel, RumbleShakesTheGyroInFlightAndDoesNotTurnIt) {
  world::SensorTruth truth = perfect();
  truth.gyro_rumble = {0.16, 0.05, 0.15};
  const ImuStatistics flying = measured(truth, at_rotor_speed(kReference), 40'000),
                      resting = measured(truth, at_rotor_speed(0), 1000);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(flying.gyro.rms[i], std::sqrt(0.8) * truth.gyro_rumble[i],
                0.07 * truth.gyro_rumble[i]);
    EXPECT_NEAR(flying.gyro.mean[i], 0.0, 2e-3 * truth.gyro_rumble[i]);
    EXPECT_NEAR(resting.gyro.rms[i], 0.0, kGyroStep);
  }
}

// x(t) = √2 sin φ(t), φ growing by ω dt and a normal step of 0.3 rad: E[x(t) x(t + dt)] is
// cos(ω dt) exp(-0.3² / 2).
TEST(ImuModel, VibrationIsAtTheRotorsFrequency) {
  world::SensorTruth truth = perfect();
  truth.accel_vibration = {5, 0, 0};
  for (const double speed : {500.0, kReference, 900.0}) {
    const BodyState state = at_rotor_speed(speed);
    ImuModel model{truth, 5};
    double sum = 0.0, sum2 = 0.0, last = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const double now = model.measure(state, kDt).accel_B.x();
      sum += now * last, sum2 += now * now;
      last = now;
    }
    EXPECT_NEAR(sum / sum2, std::cos(speed * kDt) * std::exp(-0.5 * 0.3 * 0.3), 0.02) << speed;
  }
}

TEST(ImuModel, AnUnbalancedRotorShakesMoreAndAtItsOwnFrequency) {
  world::SensorTruth truth = perfect();
  truth.accel_vibration = {2, 0, 0};
  truth.imbalance = {0, 0, 2, 0};
  BodyState state = at_rotor_speed(600.0);
  state.rotor_speed[2] = kReference;
  ImuModel model{truth, 5};
  double sum = 0.0, sum2 = 0.0, last = 0.0;
  for (int i = 0; i < 40'000; ++i) {
    const double now = model.measure(state, kDt).accel_B.x();
    sum += now * last, sum2 += now * now;
    last = now;
  }
  EXPECT_NEAR(std::sqrt(sum2 / 40'000), 2.0, 0.1);  // twice a quarter of the power, four times
  EXPECT_NEAR(sum / sum2, std::cos(kReference * kDt) * std::exp(-0.5 * 0.3 * 0.3), 0.02);
}

TEST(ImuModel, BiasesMoveAsItWarmsUp) {
  world::SensorTruth truth = perfect();
  truth.accel_warming = {0.5, -0.25, 1.0}, truth.gyro_warming = {0.1, 0.2, -0.3};
  truth.warming_time = 2.0;
  BodyState state = at_rotor_speed(0.0);
  state.specific_force_B.setZero();
  ImuModel model{truth, 1};
  Imu imu;
  for (int i = 0; i < 1024; ++i) imu = model.measure(state, kDt);
  const double part = 1.0 - std::exp(-1.0);
  EXPECT_THAT(imu.accel_B, IsNear(part * truth.accel_warming, kAccelStep));
  EXPECT_THAT(imu.gyro_B, IsNear(part * truth.gyro_warming, kGyroStep));
}

TEST(ImuModel, NoiseScaleScalesNoiseAndVibration) {
  world::SensorTruth truth;
  const auto one = measured(truth, at_rotor_speed(kReference), kSamples);
  truth.noise_scale = 2.0;
  const auto two = measured(truth, at_rotor_speed(kReference), kSamples);
  // The same random numbers: only the resolution differs.
  EXPECT_THAT(two.accel.rms, IsNear(2.0 * one.accel.rms, kAccelStep));
  EXPECT_THAT(two.gyro.rms, IsNear(2.0 * one.gyro.rms, kGyroStep));
}

TEST(ImuModel, SamplesComeAtTheImusRateWithItsJitter) {
  world::SensorTruth truth;
  for (const double jitter : {0.0, 3e-4}) {
    truth.imu_jitter = jitter;
    ImuModel model{truth, 6};
    double sum = 0.0, sum2 = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      const double off = model.next_interval() - kDt;
      ASSERT_LE(std::abs(off), 9.0001e-4);
      sum += off, sum2 += off * off;
    }
    EXPECT_NEAR(sum / kSamples, 0.0, kOfMean * jitter + 1e-15);
    // Cut at 3 standard deviations, which takes half a percent off the spread.
    EXPECT_NEAR(std::sqrt(sum2 / kSamples), jitter, 0.03 * jitter + 1e-15);
  }
}

TEST(Sensors, TheSameSeedMeasuresTheSameAndAnotherSeedOtherwise) {
  const BodyState state = [] {
    BodyState s = at_rotor_speed(kReference);
    s.p_EB.z() = -1.0;
    return s;
  }();
  const auto record = [&](std::uint64_t seed) {
    const world::SensorTruth truth;
    ImuModel imu{truth, seed};
    SonarModel sonar{truth, seed};
    BaroModel baro{truth, seed};
    std::vector<double> all;
    for (int i = 0; i < 10; ++i) {
      all.push_back(imu.next_interval());
      const Imu sample = imu.measure(state, kDt);
      for (int k = 0; k < 3; ++k) all.push_back(sample.accel_B[k]), all.push_back(sample.gyro_B[k]);
      all.push_back(sonar.measure(state, nullptr).value_or(-1.0));
      all.push_back(baro.measure(state, 0.04));
    }
    return all;
  };
  EXPECT_EQ(record(8), record(8));
  const auto one = record(8), other = record(9);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NE(one[i], other[i]) << i;
}

/// Level or tilted nose up, so high above the floor.
BodyState hovering(double height, double pitch = 0.0, double roll = 0.0) {
  BodyState state;
  state.p_EB.z() = -height;
  const Quaternion q = quaternion_of({roll, pitch, 0.4});
  state.q_EB = {q.w, q.x, q.y, q.z};
  return state;
}

world::SensorTruth exact_sonar() {
  world::SensorTruth truth;
  truth.sonar_noise = 0.0;
  return truth;
}

constexpr double kSonarStep = 1e-3;

TEST(SonarModel, LevelOverTheFloorMeasuresTheHeightWithItsNoise) {
  const world::SensorTruth truth;
  SonarModel sonar{truth, 2};
  double sum = 0.0, sum2 = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const auto range = sonar.measure(hovering(1.5), nullptr);
    ASSERT_TRUE(range);
    sum += *range - 1.5, sum2 += (*range - 1.5) * (*range - 1.5);
  }
  EXPECT_NEAR(sum / kSamples, 0.0, kOfMean * truth.sonar_noise);
  EXPECT_NEAR(std::sqrt(sum2 / kSamples), truth.sonar_noise, kOfNoise * truth.sonar_noise);
}

TEST(SonarModel, OverABoxMeasuresTheBox) {
  world::World world;
  world.obstacles = {{{0.0, 0.0}, {1.0, 1.0}, 0.3, 0.0, 0.8, false}};
  const SolidSight scene{world};
  SonarModel sonar{exact_sonar(), 1};
  EXPECT_NEAR(sonar.measure(hovering(2.0), &scene).value(), 1.2, kSonarStep);
  BodyState beside = hovering(2.0);
  beside.p_EB.x() = 3.0;
  EXPECT_NEAR(sonar.measure(beside, &scene).value(), 2.0, kSonarStep);
}

TEST(SonarModel, HearsTheNearestThingWithinFifteenDegreesOfBelow) {
  const auto range_beside = [](double degrees) {
    world::World world;  // a thin plate 1 m below, its edge so far off the vertical
    const double edge = std::tan(degrees * kDegree);
    world.obstacles = {{{edge + 1.0, 0.0}, {2.0, 6.0}, 0.0, 0.99, 1.0, false}};
    const SolidSight scene{world};
    BodyState state = hovering(2.0);
    state.q_EB = {1, 0, 0, 0};
    SonarModel sonar{exact_sonar(), 1};
    return sonar.measure(state, &scene).value();
  };
  EXPECT_NEAR(range_beside(-1.0), 1.0, kSonarStep);
  EXPECT_NEAR(range_beside(14.5), 1.0 / std::cos(15.0 * kDegree), 2 * kSonarStep);
  EXPECT_NEAR(range_beside(16.0), 2.0, kSonarStep);
}

TEST(SonarModel, TiltedLittleStillMeasuresTheHeightAndTiltedMoreTheSlope) {
  SonarModel sonar{exact_sonar(), 1};
  for (const double tilt : {-14.0, -8.0, 5.0, 11.0, 14.0})  // the nearest ray is at most 4° off
    EXPECT_NEAR(sonar.measure(hovering(2.0, tilt * kDegree), nullptr).value(), 2.0, 0.01) << tilt;
  EXPECT_NEAR(sonar.measure(hovering(2.0, 40 * kDegree), nullptr).value(),
              2.0 / std::cos(25.0 * kDegree), 0.01);
}

TEST(SonarModel, TiltedBeyondFortyFiveDegreesHearsNothing) {
  SonarModel sonar{exact_sonar(), 1};
  EXPECT_TRUE(sonar.measure(hovering(1.0, 44 * kDegree), nullptr));
  EXPECT_TRUE(sonar.measure(hovering(1.0, 0.0, -44 * kDegree), nullptr));
  EXPECT_FALSE(sonar.measure(hovering(1.0, 46 * kDegree), nullptr));
  EXPECT_FALSE(sonar.measure(hovering(1.0, 0.0, 46 * kDegree), nullptr));
  EXPECT_FALSE(sonar.measure(hovering(1.0, 0.0, 180 * kDegree), nullptr));
}

TEST(SonarModel, BeyondItsRangeHearsNothing) {
  SonarModel sonar{exact_sonar(), 1};
  EXPECT_NEAR(sonar.measure(hovering(4.99), nullptr).value(), 4.99, kSonarStep);
  EXPECT_FALSE(sonar.measure(hovering(5.01), nullptr));
  EXPECT_FALSE(sonar.measure(hovering(0.01), nullptr)) << "nor so near";
}

TEST(SonarModel, SomeEchoesAreLostAndSomeShowTwiceTheHeight) {
  world::SensorTruth truth;
  truth.sonar_loss = 0.2, truth.sonar_double = 0.1;
  SonarModel sonar{truth, 3};
  int lost = 0, twice = 0;
  constexpr int kReadings = 10'000;
  for (int i = 0; i < kReadings; ++i) {
    const auto range = sonar.measure(hovering(1.5), nullptr);
    lost += !range;
    if (!range) continue;
    const bool is_twice = *range > 2.0;
    twice += is_twice;
    EXPECT_NEAR(*range, is_twice ? 3.0 : 1.5, 0.1);
  }
  EXPECT_NEAR(lost, 0.2 * kReadings, 4 * std::sqrt(0.16 * kReadings));
  EXPECT_NEAR(twice, 0.1 * kReadings, 4 * std::sqrt(0.09 * kReadings));
}

TEST(BaroModel, TakesPartOfTheAirspeedsPressureForHeight) {
  world::SensorTruth truth;
  truth.baro_noise = truth.baro_drift = 0.0, truth.baro_airspeed = 0.5;
  BodyState state = hovering(1.0);
  state.v_E = {3.0, 0.0, 0.0}, state.wind_E = {-1.0, 0.0, 0.0};
  BaroModel baro{truth, 1};
  EXPECT_NEAR(baro.measure(state, 0.04), 1.0 + 0.5 * 16.0 / (2.0 * kGravity), 1e-9);
}

TEST(BaroModel, NoiseIsWhiteAboutTheHeight) {
  world::SensorTruth truth;
  truth.baro_drift = 0.0;
  BaroModel baro{truth, 3};
  double sum = 0.0, sum2 = 0.0, in_turn = 0.0, last = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double off = baro.measure(hovering(1.5), 0.04) - 1.5;
    sum += off, sum2 += off * off, in_turn += off * last;
    last = off;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, kOfMean * truth.baro_noise);
  EXPECT_NEAR(std::sqrt(sum2 / kSamples), truth.baro_noise, kOfNoise * truth.baro_noise);
  EXPECT_NEAR(in_turn / sum2, 0.0, kOfMean);
}

// 500 barometers: the RMS of their drift within four standard errors, 13 %.
TEST(BaroModel, DriftGrowsWithTheRootOfTimeHoweverOftenItIsRead) {
  world::SensorTruth truth;
  truth.baro_noise = 0.0;
  const std::vector<double> times{2.5, 10.0, 40.0};
  for (const double dt : {0.05, 0.25}) {
    std::vector<double> sum2(times.size());
    for (std::uint64_t seed = 1; seed <= 500; ++seed) {
      BaroModel baro{truth, seed};
      double time = 0.0, off = 0.0;
      for (std::size_t k = 0; k < times.size(); ++k) {
        for (; time < times[k] - 0.5 * dt; time += dt) off = baro.measure(hovering(1.0), dt) - 1.0;
        sum2[k] += off * off;
      }
    }
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double expected = truth.baro_drift * std::sqrt(times[k] / 10.0);
      EXPECT_NEAR(std::sqrt(sum2[k] / 500), expected, 0.13 * expected) << dt << ' ' << times[k];
    }
  }
}

}  // namespace
}  // namespace gatefly::sim
