// SPDX-License-Identifier: Apache-2.0
// What a team measures once reaches the pilot and the simulator alike.
#include "gatefly/config/derived.hpp"

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/config/config.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/part_params.hpp"

namespace gatefly::config {
namespace {

/// Settings of pilot and simulator from the same keys.
struct Told {
  explicit Told(const std::vector<std::string>& settings)
      : config{load_config(std::vector<std::filesystem::path>{}, settings)} {}

  Config config;
  const PilotConfig& pilot = config.pilot;
  world::SimConfig simulator = simulator_config(config, {});
};

TEST(Derived, TheCamerasMountIsThePilotsAndTheSimulators) {
  for (const double tilt : {-30.0, 0.0, 13.3, 60.0}) {
    const Told told{
        {"camera.tilt_deg=" + std::to_string(tilt), "camera.position_m=[0.1, 0.02, -0.03]"}};
    const Eigen::Vector3d forward_B = told.pilot.camera.R_BC * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(std::asin(forward_B.z()), tilt * kDegree, 1e-12);
    EXPECT_NEAR(forward_B.y(), 0.0, 1e-15);
    EXPECT_NEAR(told.simulator.camera.tilt_down, tilt * kDegree, 1e-12);
    EXPECT_EQ(told.pilot.camera.p_BC, Eigen::Vector3d(0.1, 0.02, -0.03));
    EXPECT_EQ(told.simulator.camera.p_BC, Eigen::Vector3d(0.1, 0.02, -0.03));
  }
}

TEST(Derived, TheLensIsThePilotsAndTheSimulators) {
  for (const char* model : {"dhane", "brown-conrady", "kannala-brandt"}) {
    std::vector<std::string> settings{std::string{"camera.model="} + model,
                                      "camera.focal_px=[150, 151]", "camera.center_px=[140, 70]"};
    if (model == std::string{"brown-conrady"})
      settings.emplace_back("camera.distortion=[-0.3, 0.1, 0.002, -0.001, -0.02]");
    if (model == std::string{"kannala-brandt"})
      settings.emplace_back("camera.distortion=[0.1, -0.02, 0.003, 0]");
    const Told told{settings};
    for (const double x : {-0.5, 0.0, 0.7}) {
      const auto px = told.pilot.camera.lens.project({x, 0.2, 1.0});
      ASSERT_TRUE(px.has_value());
      EXPECT_EQ(px, told.simulator.camera.lens.project({x, 0.2, 1.0})) << model;
    }
  }
}

TrackFile track_of(const std::vector<Eigen::Vector3d>& albedos) {
  TrackFile track;
  for (const auto& albedo : albedos) track.world.gates.push_back({.color = albedo});
  return track;
}

TEST(Derived, AGatesColourHasOneSource) {
  const Eigen::Vector3d orange{0.95, 0.40, 0.12}, red{0.75, 0.07, 0.07}, blue{0.07, 0.15, 0.75},
      white{0.85, 0.85, 0.85};
  const Config silent = Told({}).config, green = Told({"color.rgb=[0.1, 0.7, 0.2]"}).config;
  // Colours that the generic orange finds change nothing; another colour is the track's.
  for (const auto& albedo : {orange, red})
    EXPECT_EQ(on_course(silent, track_of({albedo})).pilot.gate_color.absolute,
              silent.pilot.gate_color.absolute);
  const Config on_blue = on_course(silent, track_of({blue}));
  EXPECT_GT(on_blue.gate.rgb.z(), on_blue.gate.rgb.x() + 0.3);
  EXPECT_TRUE(on_blue.notes.empty());
  EXPECT_TRUE(simulator_config(on_blue, track_of({blue})).world.gates[0].sought);
  // A configuration's colour is looked for; gates of another colour, or of none, are named.
  const auto world = simulator_config(green, track_of({blue})).world;
  EXPECT_FALSE(world.gates[0].sought);
  EXPECT_EQ(on_course(green, track_of({blue})).gate.rgb, green.gate.rgb);
  ASSERT_EQ(on_course(silent, track_of({orange, white})).notes.size(), 1u);
  EXPECT_NE(on_course(silent, track_of({orange, white})).notes[0].find("gate 2 not of the colour"),
            std::string::npos);
  EXPECT_EQ(on_course(Told({"detector.mode=flown"}).config, track_of({blue})).notes.size(), 1u);
}

// Boards of 0.22 of the side are looked for as such, without anything being said but the track.
TEST(Derived, AGatesShapeIsTheTracksUnlessTheConfigurationHasOne) {
  TrackFile wide;
  wide.world.gates = {{.side = 2.7, .bar = 0.6}};
  const Config on_wide = on_course(Told({}).config, wide);
  EXPECT_DOUBLE_EQ(on_wide.pilot.detector.bar_ratio, 0.6 / 2.7);
  EXPECT_DOUBLE_EQ(on_wide.pilot.detector.corner_scale, 2.7 / 2.1);
  const Config told = Told({"gate.side_m=2.0", "gate.bar_m=0.3"}).config;
  EXPECT_DOUBLE_EQ(on_course(told, wide).pilot.detector.bar_ratio, 0.15);
  const Config usual = Told({}).config;
  EXPECT_DOUBLE_EQ(
      on_course(usual, track_of({Eigen::Vector3d{0.95, 0.40, 0.12}})).pilot.detector.bar_ratio,
      usual.pilot.detector.bar_ratio);
}

// A stored line is an upright column where pictures are stored on their side, else a row; turned round,
// the last one is read first.
TEST(Derived, TheReadOutRunsAsThePicturesAreStored) {
  struct Case {
    int stored_deg;
    double across, down;
  };
  for (const Case& c :
       {Case{0, 0, 0.016}, Case{90, 0.016, 0}, Case{180, 0, -0.016}, Case{270, -0.016, 0}}) {
    const Told told{
        {"camera.stored_rotation_deg=" + std::to_string(c.stored_deg), "camera.readout_ms=16"}};
    EXPECT_DOUBLE_EQ(told.pilot.camera_timing.readout, c.across) << c.stored_deg;
    EXPECT_DOUBLE_EQ(told.pilot.camera_timing.readout_down, c.down) << c.stored_deg;
  }
}

// From the middle of the exposure of the middle line to arrival: half of exposure and read-out, all
// of the way.
TEST(Derived, ThePilotsLatencyIsHalfOfExposureAndReadoutAndAllOfTheWay) {
  struct Case {
    double latency_ms, exposure_ms, readout_ms, seconds;
  };
  for (const Case& c : {Case{50, 0.01, 0, 0.050005}, Case{0, 8, 0, 0.004},
                        Case{0, 0.01, 20, 0.010005}, Case{50, 4, 20, 0.062}}) {
    const Told told{{"camera.latency_ms=" + std::to_string(c.latency_ms),
                     "camera.exposure_ms=" + std::to_string(c.exposure_ms),
                     "camera.readout_ms=" + std::to_string(c.readout_ms)}};
    EXPECT_NEAR(told.pilot.camera_timing.latency, c.seconds, 1e-12);
    EXPECT_NEAR(told.pilot.camera_timing.readout, 1e-3 * c.readout_ms, 1e-12);
    EXPECT_NEAR(told.simulator.sensors.camera_latency, 1e-3 * c.latency_ms, 1e-12);
    EXPECT_NEAR(told.simulator.camera.exposure, 1e-3 * c.exposure_ms, 1e-12);
    EXPECT_NEAR(told.simulator.camera.readout, 1e-3 * c.readout_ms, 1e-12);
  }
}

// The detector measures the frame of the bars' middle lines: 0.9 m for a side of 1 m.
TEST(Derived, CornersOfAnotherKindScaleTheDetectorsFrame) {
  const auto scale = [](const std::string& corners) {
    return Told{{"gate.corners=" + corners, "gate.side_m=1", "gate.bar_m=0.1"}}
        .pilot.detector.corner_scale;
  };
  EXPECT_DOUBLE_EQ(scale("outer"), 1.0 / 0.9);
  EXPECT_DOUBLE_EQ(scale("middle"), 1.0);
  EXPECT_DOUBLE_EQ(scale("inner"), 0.8 / 0.9);
  const Told wide{{"gate.side_m=2", "gate.bar_m=0.1"}};
  EXPECT_DOUBLE_EQ(wide.pilot.detector.bar_ratio, 0.05) << "the bar, as a part of the side";
}

// A team does not know its drone fully: the pilot gets the file's inertia, the body has another.
TEST(Derived, TheTrueInertiaIsTheSimulatorsAlone) {
  const Told told{{"vehicle.inertia_kgm2=[0.002, 0.002, 0.003]", "sim.inertia_ratio=[1, 1.5, 0.5]",
                   "sim.air_moment_nms_per_m=[0.01, 0.02]"}};
  EXPECT_EQ(told.pilot.vehicle.inertia, Eigen::Vector3d(0.002, 0.002, 0.003));
  EXPECT_EQ(told.simulator.vehicle.inertia, Eigen::Vector3d(0.002, 0.003, 0.0015));
  EXPECT_EQ(told.simulator.vehicle.air_moment, Eigen::Vector2d(0.01, 0.02));
}

TEST(Derived, NoBodyHasMoreInertiaAboutAnAxisThanAboutTheOthersTogether) {
  const Told told{{"vehicle.inertia_kgm2=[0.001, 0.001, 0.0015]", "sim.inertia_ratio=[1, 9, 1]"}};
  EXPECT_NEAR(told.simulator.vehicle.inertia.y(), 0.0025, 1e-4);
  EXPECT_LT(told.simulator.vehicle.inertia.y(), 0.0025);
}

// Stored upright, a line is a row: the read-out runs down the picture.
TEST(Derived, ACameraThatStoresRowsIsReadFromAbove) {
  const Told told{{"camera.stored_rotation_deg=0", "camera.size_px=[640, 480]",
                   "camera.readout_ms=20", "camera.exposure_ms=8", "camera.latency_ms=30",
                   "camera.jpeg_quality=80"}};
  EXPECT_EQ(told.simulator.camera.stored_width, 640);
  EXPECT_EQ(told.simulator.camera.stored_height, 480);
  EXPECT_EQ(told.simulator.camera.stored_rotation, 0);
  EXPECT_EQ(told.simulator.camera.jpeg_quality, 80);
  EXPECT_DOUBLE_EQ(told.simulator.camera.readout, 0.020);
  EXPECT_DOUBLE_EQ(told.pilot.camera_timing.readout, 0.0);
  EXPECT_DOUBLE_EQ(told.pilot.camera_timing.readout_down, 0.020);
  EXPECT_DOUBLE_EQ(told.pilot.camera_timing.latency, 0.044);
}

TEST(Derived, TheVehicleIsThePilotsAndTheSimulators) {
  const Told told{{"vehicle.mass_kg=0.5", "vehicle.inertia_kgm2=[0.001, 0.002, 0.003]",
                   "vehicle.arm_m=[0.2, 0.3]", "vehicle.thrust_coefficient=2e-6",
                   "vehicle.torque_coefficient_m=0.02", "vehicle.max_rotor_radps=1300",
                   "sim.inertia_ratio=[1, 1, 1]"}};
  const auto expect = [](const auto& vehicle) {
    EXPECT_EQ(vehicle.mass, 0.5);
    EXPECT_EQ(vehicle.inertia, Eigen::Vector3d(0.001, 0.002, 0.003));
    EXPECT_EQ(vehicle.arm_x, 0.2);
    EXPECT_EQ(vehicle.arm_y, 0.3);
    EXPECT_EQ(vehicle.thrust_coefficient, 2e-6);
    EXPECT_EQ(vehicle.torque_coefficient, 0.02);
    EXPECT_EQ(vehicle.max_speed, 1300.0);
  };
  expect(told.pilot.vehicle);
  expect(told.simulator.vehicle);
}

TEST(Derived, RatesArePilotsAndSimulatorsAndTheRestLastsAsLong) {
  const Told told{{"vehicle.imu_hz=1000", "vehicle.sonar_hz=10", "vehicle.baro_hz=50"}};
  EXPECT_EQ(told.pilot.imu_hz, 1000.0);
  EXPECT_EQ(told.pilot.altimeter.sonar_hz, 10.0);
  EXPECT_EQ(told.simulator.sensors.imu_hz, 1000.0);
  EXPECT_EQ(told.simulator.sensors.sonar_hz, 10.0);
  EXPECT_EQ(told.simulator.sensors.baro_hz, 50.0);
  EXPECT_EQ(phase_params(told.pilot).rest_samples, 1500);
  EXPECT_EQ(phase_params(Told{{"vehicle.imu_hz=200"}}.pilot).rest_samples, 300);
  EXPECT_EQ(phase_params(Told{{}}.pilot).rest_samples, 768);
}

// As that of the vehicle's IMU the nominal rate of the autopilot's is told, unless somebody says
// another; the rest lasts as long.
TEST(Derived, AnAutopilotsImuIsToldToThePilotByItsRateAlone) {
  const Told told{{"sim.autopilot_imu_hz=50", "sim.autopilot_accel_cutoff_hz=40"}};
  EXPECT_EQ(told.simulator.sensors.autopilot_imu_hz, 50.0);
  EXPECT_EQ(told.simulator.sensors.autopilot_accel_cutoff, 40.0);
  EXPECT_EQ(told.pilot.filter_imu_hz, 50.0);
  EXPECT_EQ(told.pilot.imu_hz, 512.0);
  EXPECT_EQ(navigator_params(told.pilot).slow_imu_hz, 50.0);
  EXPECT_EQ(phase_params(told.pilot).rest_samples, 75);
  const Told other{{"sim.autopilot_imu_hz=50", "filter.imu_hz=60"}};
  EXPECT_EQ(other.pilot.filter_imu_hz, 60.0);
  EXPECT_EQ(other.simulator.sensors.autopilot_imu_hz, 50.0);
  EXPECT_EQ(Told{{}}.pilot.filter_imu_hz, 0.0);
  PilotConfig drag = told.pilot;  // as a replay flies it with --estimator drag
  drag.filter_model = FilterModel::kDrag;
  EXPECT_EQ(navigator_params(drag).slow_imu_hz, 0.0);
  EXPECT_EQ(phase_params(drag).rest_samples, 768);
}

// The pilot's rotor model is what it believes; the simulator's is the truth, and its own key.
TEST(Derived, RotorsLagAsEachIsTold) {
  const Told told{{"vehicle.rotor_time_constant_ms=30", "sim.rotor_time_constant_ms=40"}};
  EXPECT_DOUBLE_EQ(told.pilot.vehicle.rotor_time_constant, 0.030);
  EXPECT_DOUBLE_EQ(told.simulator.vehicle.rotor_time_constant, 0.040);
}

}  // namespace
}  // namespace gatefly::config
