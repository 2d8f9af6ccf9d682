// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/config.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::config {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Files = std::vector<std::filesystem::path>;
using Settings = std::vector<std::string>;

Config with(const Settings& settings) { return load_config(Files{}, settings); }
/// The simulator's half, on no track.
world::SimConfig simulator(const Config& config) { return simulator_config(config, {}); }
std::string error_with(const std::string& setting) {
  return test::error_of([&] { (void)with({setting}); });
}

TEST(Config, HasEveryKeyOnceAndEveryDefaultInItsOwnRange) {
  std::set<std::string> names;
  const Config config;
  for (const auto& key : config_keys()) {
    EXPECT_TRUE(names.insert(key.rule.name).second) << key.rule.name;
    EXPECT_FALSE(key.rule.what.empty()) << key.rule.name;
    EXPECT_FALSE(key.rule.source.empty()) << key.rule.name;
    EXPECT_NO_THROW((void)checked(key.rule, key.get(config), "default")) << key.rule.name;
  }
}

TEST(Config, WritingAValueBackChangesNothing) {
  const Config original;
  Config copy;
  for (const auto& key : config_keys()) key.set(copy, key.get(original));
  EXPECT_EQ(as_json(copy), as_json(original));
}

TEST(Config, ConvertsUnitsOfKeysToSi) {
  const Config config = with({"control.max_roll_deg=30", "camera.readout_ms=10"});
  EXPECT_DOUBLE_EQ(config.pilot.lateral.max_roll, 30 * kDegree);
  EXPECT_DOUBLE_EQ(config.camera.readout, 0.010);
}

TEST(Config, CameraIsThePilotsBeliefAndTheSimulatorsNominal) {
  const Config config =
      with({"camera.tilt_deg=10", "camera.focal_px=[150, 151]", "camera.size_px=[320, 180]",
            "camera.latency_ms=50", "camera.exposure_ms=4", "camera.readout_ms=20"});
  const Eigen::Vector3d forward_B = config.pilot.camera.R_BC * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::asin(forward_B.z()), 10 * kDegree, 1e-12);
  EXPECT_DOUBLE_EQ(simulator(config).camera.tilt_down, 10 * kDegree);
  EXPECT_EQ(std::get<DhaneFisheye>(config.pilot.camera.lens.model).focal_px,
            Eigen::Vector2d(150, 151));
  EXPECT_EQ(std::get<DhaneFisheye>(simulator(config).camera.lens.model).focal_px,
            Eigen::Vector2d(150, 151));
  EXPECT_EQ(simulator(config).camera.stored_width, 180);
  EXPECT_EQ(simulator(config).camera.stored_height, 320);
  EXPECT_DOUBLE_EQ(simulator(config).sensors.camera_latency, 0.050);
  EXPECT_DOUBLE_EQ(config.pilot.camera_timing.latency, 0.050 + 0.002 + 0.010);
}

TEST(Config, VehicleIsThePilotsBeliefAndTheSimulatorsNominalButForTheRotors) {
  const Config config = with({"vehicle.mass_kg=0.5", "vehicle.arm_m=[0.2, 0.1]",
                              "vehicle.rotor_time_constant_ms=30", "vehicle.min_rotor_radps=200"});
  EXPECT_EQ(config.pilot.vehicle.mass, 0.5);
  EXPECT_EQ(config.pilot.vehicle.min_speed, 200);
  EXPECT_DOUBLE_EQ(config.pilot.vehicle.rotor_time_constant, 0.030);
  const world::VehicleTruth truth = simulator(config).vehicle;
  EXPECT_EQ(truth.mass, 0.5);
  EXPECT_EQ(truth.arm_x, 0.2);
  EXPECT_EQ(truth.arm_y, 0.1);
  EXPECT_EQ(truth.min_speed, world::VehicleTruth{}.min_speed);
  EXPECT_EQ(truth.rotor_time_constant, world::VehicleTruth{}.rotor_time_constant);
}

TEST(Config, TheSimulatorsOwnSettingsReachItAloneAndTheTracksWorldWithThem) {
  const Config config =
      with({"sim.size_m=[0.5, 0.4, 0.1]", "sim.baro_noise_m=0.3", "sim.ideal_detector=paper",
            "sim.bake_threads=3", "sim.timeout_s=9", "sim.camera_quality=fast"});
  TrackFile track;
  track.world.look = "showroom";
  track.start.heading = 0.5;
  const world::SimConfig sim = simulator_config(config, track);
  EXPECT_EQ(sim.vehicle.size, Eigen::Vector3d(0.5, 0.4, 0.1));
  EXPECT_EQ(sim.sensors.baro_noise, 0.3);
  EXPECT_EQ(sim.ideal_vision.detector, "paper");
  EXPECT_EQ(sim.bake_threads, 3);
  EXPECT_TRUE(sim.camera.fast);
  EXPECT_EQ(config.sim.timeout, 9);
  EXPECT_EQ(sim.world.look, "showroom");
  EXPECT_EQ(sim.start.heading, 0.5);
}

TEST(Config, WithoutAnyFilePilotAndSimulatorHaveTheDefaultsOfTheirOwnTypes) {
  const Config config;
  const PilotConfig pilot;
  EXPECT_EQ(config.pilot.camera_timing.latency, pilot.camera_timing.latency);
  EXPECT_EQ(config.pilot.camera_timing.readout, pilot.camera_timing.readout);
  EXPECT_DOUBLE_EQ(config.pilot.detector.corner_scale, pilot.detector.corner_scale);
  EXPECT_EQ(config.pilot.detector.bar_ratio, pilot.detector.bar_ratio);
  const world::SimConfig nominal = simulator(config), sim;
  EXPECT_EQ(nominal.camera.p_BC, sim.camera.p_BC);
  EXPECT_NEAR(nominal.camera.tilt_down, sim.camera.tilt_down, 1e-6);
  EXPECT_EQ(nominal.camera.stored_width, sim.camera.stored_width);
  EXPECT_EQ(nominal.camera.stored_height, sim.camera.stored_height);
  EXPECT_EQ(nominal.camera.exposure, sim.camera.exposure);
  EXPECT_EQ(nominal.camera.readout, sim.camera.readout);
  EXPECT_EQ(nominal.sensors.camera_hz, sim.sensors.camera_hz);
  EXPECT_EQ(nominal.sensors.camera_latency, sim.sensors.camera_latency);
  EXPECT_EQ(nominal.vehicle.mass, sim.vehicle.mass);
  EXPECT_EQ(nominal.vehicle.inertia, sim.vehicle.inertia);
  EXPECT_EQ(nominal.vehicle.arm_x, sim.vehicle.arm_x);
  EXPECT_EQ(nominal.vehicle.arm_y, sim.vehicle.arm_y);
  EXPECT_EQ(nominal.vehicle.thrust_coefficient, sim.vehicle.thrust_coefficient);
  EXPECT_EQ(nominal.vehicle.torque_coefficient, sim.vehicle.torque_coefficient);
  EXPECT_EQ(nominal.vehicle.max_speed, sim.vehicle.max_speed);
}

TEST(Config, APinholeIsTheFisheyeWithoutDistortionInTheSimulator) {
  const Config config = with({"camera.model=pinhole"});
  EXPECT_TRUE(std::holds_alternative<Pinhole>(config.pilot.camera.lens.model));
  EXPECT_EQ(std::get<DhaneFisheye>(simulator(config).camera.lens.model).k, 1.0);
}

TEST(Config, BrownConradysCoefficientsComeInOpenCvsOrderForPilotAndSimulator) {
  const Config config =
      with({"camera.model=brown-conrady", "camera.distortion=[-0.3, 0.1, 0.002, -0.001, 0.05]",
            "camera.center_px=[150, 80]"});
  for (const AnyCamera& camera : {config.pilot.camera.lens, simulator(config).camera.lens}) {
    const auto& lens = std::get<BrownConrady>(camera.model);
    EXPECT_EQ(lens.distortion(), (BrownConrady::Coefficients{-0.3, 0.1, 0.002, -0.001, 0.05}));
    EXPECT_EQ(lens.center_px, Eigen::Vector2d(150, 80));
  }
}

TEST(Config, KannalaBrandtHasFourCoefficients) {
  const Config config =
      with({"camera.model=kannala-brandt", "camera.distortion=[0.1, -0.02, 0.003, 0]"});
  for (const AnyCamera& camera : {config.pilot.camera.lens, simulator(config).camera.lens})
    EXPECT_EQ(std::get<KannalaBrandt>(camera.model).radial.coefficients(),
              (RadialPolynomial::Coefficients{0.1, -0.02, 0.003, 0.0}));
}

TEST(Config, AWrongNumberOfCoefficientsIsRefusedSayingHowManyTheModelNeeds) {
  const auto error = [](const Settings& settings) {
    return test::error_of([&] { (void)with(settings); });
  };
  EXPECT_EQ(error({"camera.model=brown-conrady", "camera.distortion=[-0.3, 0.1]"}),
            "--set: camera.distortion = [-0.3, 0.1], must be 5 numbers [k1, k2, p1, p2, k3] in "
            "-1000..1000 with "
            "camera.model = \"brown-conrady\"");
  EXPECT_THAT(error({"camera.model=kannala-brandt"}),
              HasSubstr("= [1.08] (the default), must be 4 numbers [k1, k2, k3, k4]"));
  EXPECT_THAT(error({"camera.distortion=[]"}),
              HasSubstr("must be 1 number [k] in 0.5..2 with camera.model = \"dhane\""));
  EXPECT_THAT(error({"camera.distortion=3"}), HasSubstr("= [3], must be 1 number [k] in 0.5..2"));
  EXPECT_THAT(error({"camera.model=pinhole", "camera.distortion=1.08"}),
              HasSubstr("must be [] with"));
  EXPECT_EQ(error({"camera.model=pinhole", "camera.distortion=[]"}), "");
  EXPECT_THAT(error({"camera.model=kannala-brandt", "camera.distortion=[0, 0, nan, 0]"}),
              HasSubstr("nan"));
  EXPECT_THAT(error({"camera.distortion=[1, 2, 3, 4, 5, 6]"}), HasSubstr("a list of at most 5"));
}

TEST(Config, AWholeNumberMayBeWrittenWithAPoint) {
  const Config config = with({"control.rest_samples=1e3", "camera.size_px=[320.0, 160]"});
  EXPECT_EQ(config.pilot.phase.rest_samples, 1000);
  EXPECT_EQ(config.camera.width, 320);
}

TEST(Config, LaterFilesWinAndSettingsComeLast) {
  const test::TempFolder folder;
  const Files files{
      folder.file(
          "a.toml",
          "[control]\nrest_samples = 100\n[detector]\nmin_side_px = 11\n[gate]\nbar_m = 0.07\n"),
      folder.file("b.toml", "[control]\nrest_samples = 200\n[detector]\nmin_side_px = 22\n")};
  const Config config = load_config(files, Settings{"detector.min_side_px=33"});
  EXPECT_EQ(config.gate.bar, 0.07);
  EXPECT_EQ(config.pilot.phase.rest_samples, 200);
  EXPECT_EQ(config.pilot.detector.min_side_px, 33);
  EXPECT_EQ(config.set_by.at("gate.bar_m"), files[0].string() + ":6");
  EXPECT_EQ(config.set_by.at("control.rest_samples"), files[1].string() + ":2");
  EXPECT_EQ(config.set_by.at("detector.min_side_px"), "--set");
}

TEST(Config, KeysOfTheColourBoxStillLoadAndAreSaidToHaveNoEffect) {
  const Config config = with({"color.y_min=7", "detector.open_samples=100"});
  ASSERT_EQ(config.notes.size(), 2u);
  EXPECT_THAT(config.notes[0],
              AllOf(HasSubstr("--set"), HasSubstr("color.y_min has no effect any more"),
                    HasSubstr("color.table")));
  EXPECT_TRUE(config.set_by.empty());
  EXPECT_TRUE(with({}).notes.empty());
}

TEST(Config, TheOldNameOfARenamedKeySetsItAndIsSaidToBeOld) {
  const Config config =
      with({"pose.white_px=0.5", "pose.white_part_px=0.9", "sim.ghosts_percent=30"});
  EXPECT_EQ(config.pilot.pose.random_sigma_px, 0.5);
  EXPECT_EQ(config.pilot.pose.random_part_sigma_px, 0.9);
  EXPECT_DOUBLE_EQ(config.sim.ideal_vision.outliers, 0.3);
  ASSERT_EQ(config.notes.size(), 3u);
  EXPECT_THAT(config.notes[0],
              HasSubstr("--set: pose.white_px is the old name of pose.random_sigma_px"));
  EXPECT_EQ(config.set_by.at("sim.outliers_percent"), "--set");
  EXPECT_THAT(show(config), AllOf(HasSubstr("outliers_percent"), Not(HasSubstr("ghosts_percent")),
                                  Not(HasSubstr("white_px"))));
  EXPECT_THAT(error_with("pose.white_px=-1"), HasSubstr("pose.random_sigma_px = -1"));
}

TEST(Config, OldAndNewNameOfAKeyInOneFileAreRefused) {
  const test::TempFolder folder;
  const auto both = folder.file("both.toml", "[pose]\nrandom_sigma_px = 1\nwhite_px = 2\n"),
             old_name = folder.file("old.toml", "[pose]\nwhite_px = 2\n");
  EXPECT_THAT(
      test::error_of([&] { (void)load_config(Files{both}); }),
      AllOf(HasSubstr("both.toml:3"), HasSubstr("is the old name of pose.random_sigma_px")));
  EXPECT_EQ(
      load_config(Files{old_name}, Settings{"pose.random_sigma_px=3"}).pilot.pose.random_sigma_px,
      3.0);
}

TEST(Config, RecordedConfigurationsAreReadUnderThePresentNames) {
  const auto today = as_json(with({"sim.ghosts_percent=20"}));
  auto earlier = today;
  earlier["sim"]["ghosts_percent"] = earlier["sim"]["outliers_percent"];
  earlier["sim"].erase("outliers_percent");
  EXPECT_NE(earlier, today);
  EXPECT_EQ(with_current_names(earlier), today);
  EXPECT_EQ(with_current_names(today), today);
  for (const nlohmann::json& nonsense : {nlohmann::json(7), nlohmann::json{{"sim", 3}}})
    EXPECT_EQ(with_current_names(nonsense), nonsense);
}

TEST(Config, UnknownKeySuggestsTheNearest) {
  EXPECT_THAT(error_with("control.rest_sampels=3"),
              AllOf(HasSubstr("--set"), HasSubstr("'control.rest_samples'")));
  EXPECT_THAT(error_with("randomize.gate_positon_m=3"), HasSubstr("'gate_position_m'"));
  const test::TempFolder folder;
  const auto file = folder.file("a.toml", "[kamera]\ntilt_deg = 3\n");
  EXPECT_THAT(test::error_of([&] { (void)load_config(Files{file}); }),
              AllOf(HasSubstr("a.toml"), HasSubstr("[kamera]"), HasSubstr("'camera'")));
}

TEST(Config, RefusesWrongTypesNanAndRangesNamingFileKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(error_with("control.rest_samples=2.5"),
            "--set: control.rest_samples = 2.5, must be a whole number in 1..100000");
  EXPECT_THAT(error_with("camera.tilt_deg=nan"),
              HasSubstr("camera.tilt_deg = nan, must be a number in -90..90"));
  EXPECT_THAT(error_with("camera.tilt_deg=inf"), HasSubstr("must be"));
  EXPECT_THAT(error_with("camera.tilt_deg=\"steep\""), HasSubstr("\"steep\", must be a number"));
  EXPECT_THAT(error_with("camera.tilt_deg=91"), HasSubstr("= 91, must be a number in -90..90"));
  EXPECT_THAT(error_with("camera.focal_px=[168.0]"), HasSubstr("must be 2 numbers"));
  EXPECT_THAT(error_with("camera.size_px=[315.5, 160]"), HasSubstr("whole numbers"));
  EXPECT_THAT(error_with("camera.model=fish"),
              HasSubstr("one of \"dhane\", \"pinhole\", \"brown-conrady\", \"kannala-brandt\""));
  EXPECT_THAT(error_with("camera.stored_rotation_deg=45"), HasSubstr("must be 0, 90, 180 or 270"));
  EXPECT_THAT(
      test::error_of([] {
        (void)with({"pose.min_bars_distance_m=3", "pose.max_bars_distance_m=2"});
      }),
      HasSubstr("pose.min_bars_distance_m = 3, must be at most pose.max_bars_distance_m = 2"));
  EXPECT_THAT(error_with("gate.bar_m=0.6"), HasSubstr("gate.side_m"));
  EXPECT_THAT(error_with("control.speed_mps"), HasSubstr("section.key=value"));
  EXPECT_THAT(error_with("control.speed_mps="), HasSubstr("must be a number"));
}

std::string error_of_all(const std::vector<std::string>& settings) {
  return test::error_of([&] { (void)with(settings); });
}

TEST(Config, AnAutopilotsImuThatNoFilterTakesIsRefused) {
  for (const std::string key : {"filter.imu_hz", "sim.autopilot_imu_hz"}) {
    EXPECT_EQ(error_of_all({key + "=25"}), "");
    EXPECT_EQ(error_of_all({key + "=10"}), "--set: " + key + " = 10, must be 0 or in 25..512");
    EXPECT_EQ(error_of_all({key + "=300", "vehicle.imu_hz=200"}),
              "--set: " + key + " = 300, must be at most vehicle.imu_hz = 200");
    EXPECT_EQ(error_of_all({key + "=50", "filter.model=drag"}),
              "--set: " + key +
                  " = 50, must be 0 with filter.model = \"drag\", which takes every sample");
    EXPECT_THAT(error_of_all({key + "=50", "pose.model=paper"}), HasSubstr("pose.model"));
  }
  EXPECT_EQ(error_of_all({"sim.autopilot_imu_hz=50", "sim.autopilot_gyro_cutoff_hz=256"}),
            "--set: sim.autopilot_gyro_cutoff_hz = 256, must be less than half of vehicle.imu_hz = "
            "512");
  EXPECT_EQ(error_of_all({"sim.autopilot_gyro_cutoff_hz=256"}), "") << "nobody filters";
  EXPECT_EQ(error_of_all({"sim.autopilot_imu_hz=50", "vehicle.imu_hz=200",
                          "sim.autopilot_gyro_cutoff_hz=90"}),
            "");
}

TEST(Config, ErrorsAreOneLine) {
  const test::TempFolder folder;
  const auto file = folder.file("broken.toml", "[camera]\ntilt_deg = = 3\n");
  const std::string error = test::error_of([&] { (void)load_config(Files{file}); });
  EXPECT_THAT(error, AllOf(HasSubstr("broken.toml:2"), Not(HasSubstr("\n"))));
}

TEST(Config, RandomizeGoesOverTheTracksOwn) {
  const Config config = with({"randomize.level=none", "randomize.gate_heading_deg=5"});
  const world::Randomize result =
      randomized(world::randomize_level("hard"), config.randomize, "--set");
  EXPECT_DOUBLE_EQ(result.gate_heading, 5 * kDegree);
  EXPECT_EQ(result.gate_position, 0.0);
}

TEST(Config, ShowsEveryKeyWithItsSource) {
  const std::string text = show(with({"control.speed_mps=1.25"}));
  for (const auto& key : config_keys())
    EXPECT_THAT(text, HasSubstr(key.rule.name.substr(key.rule.name.find('.') + 1) + " "))
        << key.rule.name;
  EXPECT_THAT(text, HasSubstr("1.25"));
  EXPECT_THAT(text, HasSubstr("m/s, speed on straights; set by --set"));
}

TEST(Config, ShippedFilesLoad) {
  for (const char* name :
       {"configs/default.toml", "configs/flights.toml", "configs/li18.toml", "cameras/bebop.toml",
        "cameras/bebop-brown.toml", "cameras/wide-usb.toml", "cameras/grandprix.toml",
        "cameras/global-shutter.toml", "cameras/imx477.toml", "vehicles/bebop.toml",
        "vehicles/racer.toml", "vehicles/archer-b2.toml"})
    EXPECT_NO_THROW((void)load_config(Files{files::shipped_dir() / name})) << name;
}

// The whole original in one file: every box is the paper's.
TEST(Config, Li18IsThePaperInEveryBox) {
  const PilotConfig pilot = load_config(Files{files::shipped_dir() / "configs/li18.toml"}).pilot;
  EXPECT_EQ(pilot.detector_mode, DetectorMode::kFlown);
  EXPECT_EQ(pilot.pose_scheme, Scheme::kPaper);
  EXPECT_EQ(pilot.filter_model, FilterModel::kPaper);
  EXPECT_EQ(pilot.control_scheme, Scheme::kPaper);
  EXPECT_DOUBLE_EQ(pilot.paper_control.pitch, -5.0 * kDegree);
}

TEST(Config, ShippedDefaultAndBebopFilesAreTheDefaults) {
  const std::filesystem::path root = files::shipped_dir();
  const Config bebop = load_config(Files{root / "configs/default.toml", root / "cameras/bebop.toml",
                                         root / "vehicles/bebop.toml"});
  EXPECT_EQ(as_json(bebop), as_json(Config{}));
}

TEST(Config, AKeyWithoutItsUnitIsSuggestedWithIt) {
  EXPECT_THAT(error_with("control.speed=1"), HasSubstr("did you mean 'control.speed_mps'?"));
  EXPECT_THAT(error_with("camera.tilt=1"), HasSubstr("did you mean 'camera.tilt_deg'?"));
}

}  // namespace
}  // namespace gatefly::config
