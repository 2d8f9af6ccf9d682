// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/flight_folder.hpp"

#include <array>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/film_pipe.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/xxh64.hpp"
#include "gatefly/flight_log/flight_recorder.hpp"
#include "gatefly/flight_log/recording.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::flight_log {
namespace {

using ::testing::HasSubstr;

const char* const kRealHeader =
    "t_s,gyro_p_radps,gyro_q_radps,gyro_r_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2,ahrs_phi_rad,ahrs_"
    "theta_rad,"
    "ahrs_psi_rad,ot_x_m,ot_y_m,ot_z_m,ot_vx_mps,ot_vy_mps,ot_vz_mps\n";

Pilot any_pilot() {
  PilotConfig config;
  config.track.gates = {MapGate{.p_EG = {4, 0, -1.5}}};
  return Pilot{config};
}

class Recording : public ::testing::Test {
 protected:
  /// One tick with numbers that are hard to write exactly.
  void record(FlightRecorder& recorder, int row, std::span<const std::uint8_t> frame = {}) {
    Sensors sensors{.time = std::chrono::nanoseconds{1'953'125LL * row + 7}, .imu = {}};
    sensors.imu.gyro_B = {0.1 + row, 1.0 / 3.0, -5e-324};
    sensors.imu.accel_B = {1e300, std::nextafter(-9.81, 0.0), 0.0};
    if (row % 2 == 0) sensors.sonar = 2.0 / 7.0;
    const Command command{.attitude = {}, .motors = {1, 2, 3, 4}};
    Truth truth;
    truth.p_EB = {1.1, 2.2, -3.3};
    truth.attitude = {.roll = 0.1, .pitch = -0.2, .yaw = 3.0};
    recorder.record(
        {.sensors = sensors, .command = command, .pilot = pilot_, .truth = truth, .frame = frame});
  }
  test::TempFolder folder_;
  Pilot pilot_ = any_pilot();
};

class RecordingInEitherLog : public Recording, public ::testing::WithParamInterface<bool> {};

TEST_P(RecordingInEitherLog, ReadsBackExactly) {
  const std::vector<std::uint8_t> frame{1, 2, 3, 4, 5, 6, 7, 8};
  const bool packed = GetParam();
  FlightRecorder recorder(folder_.path() / "a" / "flight", {.packed_log = packed});
  for (int row = 0; row < 100; ++row)
    record(recorder, row, row == 42 ? std::span{frame} : std::span<const std::uint8_t>{});
  recorder.add_file("report.html", "<p>");
  recorder.finish("{}");

  const FlightFolder flight = read_flight_folder(folder_.path() / "a" / "flight");
  EXPECT_EQ(flight.log.filename(), packed ? "log_si.csv.gz" : "log_si.csv");
  ASSERT_EQ(flight.samples.size(), 100u);
  const FlightSample& sample = flight.samples[42];
  EXPECT_EQ(sample.time.count(), 1'953'125LL * 42 + 7);
  EXPECT_EQ(sample.imu.gyro_B, Eigen::Vector3d(42.1, 1.0 / 3.0, -5e-324));
  EXPECT_EQ(sample.imu.accel_B, Eigen::Vector3d(1e300, std::nextafter(-9.81, 0.0), 0.0));
  EXPECT_EQ(sample.sonar, 2.0 / 7.0);
  EXPECT_FALSE(sample.baro.has_value());
  EXPECT_FALSE(flight.samples[43].sonar.has_value());
  EXPECT_EQ(sample.true_p_EB, Eigen::Vector3d(1.1, 2.2, -3.3));
  EXPECT_EQ(sample.true_attitude->yaw, 3.0);
  EXPECT_TRUE(sample.est_p_EB.has_value());
  ASSERT_EQ(flight.images.size(), 1u);
  EXPECT_EQ(flight.images[0].log_row, 42u);
  EXPECT_EQ(flight.images[0].time, sample.time);
  EXPECT_EQ(flight.images[0].xxh64, files::xxh64(frame));
  EXPECT_EQ(sample.motors, (std::array<double, 4>{1, 2, 3, 4}));
  EXPECT_FALSE(std::filesystem::exists(flight.images[0].path));
  EXPECT_EQ(where_pictures_are(flight), Pictures::kHashes);
}
INSTANTIATE_TEST_SUITE_P(Log, RecordingInEitherLog, ::testing::Bool());

TEST(FlightFolder, OneThatWasCutIsReadUpToItsLastWholeLineAndPicture) {
  const test::TempFolder folder;
  const std::string log =
      "t_ns,gyro_p_radps,gyro_q_radps,gyro_r_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2\n"
      "0,0,0,0,0,0,-9.81\n4000000,0,0,0,0,0,-9.81\n8000000,0,0";
  (void)folder.file("log_si.csv", log);
  (void)folder.file("images.csv",
                    "image,t_ns,log_row\na.jpg,0,0\nb.jpg,4000000,1\nc.jpg,8000000,2\nd.jp");
  (void)folder.file("a.jpg", "x");
  (void)folder.file("b.jpg", "");  // listed, but its bytes never reached the disk
  EXPECT_THAT(test::error_of([&] { (void)read_flight_folder(folder.path()); }),
              HasSubstr("log_si.csv:4: has 3 cells"))
      << "what is no recorder's must be whole";
  (void)folder.file(kRecordingMark, "{}");
  const FlightFolder cut = read_flight_folder(folder.path());
  EXPECT_EQ(cut.samples.size(), 2);
  ASSERT_EQ(cut.images.size(), 1);
  EXPECT_EQ(cut.images[0].path.filename(), "a.jpg");
  (void)folder.file("summary.json", "{}");
  EXPECT_THAT(test::error_of([&] { (void)read_flight_folder(folder.path()); }),
              HasSubstr("log_si.csv:4"))
      << "its end was written: it must be whole, too";
}

TEST_F(Recording, AnAutopilotsImuIsKeptWhereItArrived) {
  const Command command;
  const Imu sample{{1.0 / 3.0, -5e-324, 2.0}, {0.1, 1e300, -9.81}};
  FlightRecorder recorder(folder_.path() / "flight", {.navigation_imu = true});
  for (int row = 0; row < 4; ++row) {
    Sensors sensors{.time = std::chrono::milliseconds{2 * row}, .imu = {}};
    if (row == 2) sensors.navigation_imu = sample;
    if (row == 3) sensors.navigation_imu = Imu{{std::nan(""), 0, 0}, {0, 0, 0}};
    recorder.record(
        {.sensors = sensors, .command = command, .pilot = pilot_, .truth = {}, .frame = {}});
  }
  recorder.finish("{}");
  const FlightFolder flight = read_flight_folder(folder_.path() / "flight");
  ASSERT_EQ(flight.samples.size(), 4u);
  EXPECT_FALSE(flight.samples[1].navigation_imu.has_value());
  ASSERT_TRUE(flight.samples[2].navigation_imu.has_value());
  EXPECT_EQ(flight.samples[2].navigation_imu->gyro_B, sample.gyro_B);
  EXPECT_EQ(flight.samples[2].navigation_imu->accel_B, sample.accel_B);
  EXPECT_FALSE(flight.samples[3].navigation_imu.has_value()) << "no use to the pilot either";
  const auto ticks = ticks_of(flight);
  EXPECT_TRUE(ticks[2].sensors.navigation_imu.has_value());
  EXPECT_FALSE(ticks[1].sensors.navigation_imu.has_value());
}

TEST_F(Recording, HowLateAPictureWasIsKeptAndReplayed) {
  const std::vector<std::uint8_t> frame{1, 2, 3, 4};
  FlightRecorder recorder(folder_.path() / "flight", {.picture_late = true});
  const double late = 0.012345678;
  for (int row = 0; row < 4; ++row) {
    Sensors sensors{.time = std::chrono::nanoseconds{1'953'125LL * row}, .imu = {}};
    sensors.imu.accel_B = {0, 0, -9.81};
    if (row == 2) sensors.picture_late = late;
    recorder.record({.sensors = sensors,
                     .command = {},
                     .pilot = pilot_,
                     .truth = {},
                     .frame = row == 2 ? std::span{frame} : std::span<const std::uint8_t>{}});
  }
  recorder.finish("{}");
  const FlightFolder flight = read_flight_folder(folder_.path() / "flight");
  ASSERT_EQ(flight.images.size(), 1u);
  EXPECT_EQ(flight.images[0].late, std::chrono::nanoseconds{12'345'678});
  EXPECT_EQ(ticks_of(flight).at(2).sensors.picture_late, late);
}

TEST_F(Recording, WithoutAnAutopilotsImuTheLogHasNoColumnsForIt) {
  FlightRecorder recorder(folder_.path() / "flight");
  record(recorder, 0);
  recorder.finish("{}");
  const std::string log = files::read_file(folder_.path() / "flight" / "log_si.csv");
  EXPECT_THAT(log.substr(0, log.find('\n')), ::testing::EndsWith(",battery_v"));
}

TEST_F(Recording, FramesAreKeptInOneFilmToTheBit) {
  if (!test::error_of(files::require_ffmpeg).empty()) GTEST_SKIP() << "there is no ffmpeg";
  constexpr int kWidth = 32, kHeight = 18, kFrames = 30;
  const auto frame_of = [](int row) {
    std::vector<std::uint8_t> frame(2 * kWidth * kHeight);
    std::uint32_t state = 1U + static_cast<std::uint32_t>(row);
    for (auto& byte : frame)
      byte = static_cast<std::uint8_t>((state = 1664525 * state + 1013904223) >> 24);
    return frame;
  };
  const auto out = folder_.path() / "flight";
  FlightRecorder recorder(out, {.frames = true, .stored_width = kWidth, .stored_height = kHeight});
  for (int row = 0; row < kFrames; ++row) record(recorder, row, frame_of(row));
  recorder.finish("{}");

  const FlightFolder flight = read_flight_folder(out);
  EXPECT_EQ(where_pictures_are(flight), Pictures::kFilm);
  HashCheck hashes;
  const auto pictures = checked(pictures_in_film(flight, kWidth, kHeight), flight, hashes);
  for (const int row : {0, 1, 2, 7, kFrames - 1, kFrames - 1, 3})  // also back again
    EXPECT_EQ(pictures(static_cast<std::size_t>(row)).bytes, frame_of(row)) << row;
  EXPECT_EQ(hashes.checked, 7u);
  EXPECT_EQ(hashes.others, 0u);
  EXPECT_THAT(test::error_of([&] { (void)pictures_in_film(flight, kHeight, kWidth)(0); }),
              HasSubstr("frames.mkv: its pictures are 32 x 18, the camera's as stored 18 x 32"));
  FlightFolder more = flight;
  more.images.push_back(more.images.back());
  EXPECT_THAT(test::error_of([&] { (void)pictures_in_film(more, kWidth, kHeight)(kFrames); }),
              HasSubstr("frames.mkv: ends after 30 pictures, images.csv has 31"));
}

TEST_F(Recording, APictureWithAnotherHashIsCounted) {
  const std::vector<std::uint8_t> frame{1, 2, 3, 4, 5, 6, 7, 8};
  const auto out = folder_.path() / "flight";
  {
    FlightRecorder recorder(out);
    for (int row = 0; row < 3; ++row) record(recorder, row, frame);
    recorder.finish("{}");
  }
  for (const char* name : {"frame_00000.uyvy", "frame_00001.uyvy", "frame_00002.uyvy"})
    files::write_file(out / name,
                      std::string{"\1\2\3\4\5\6\7", 7} + (name[10] == '1' ? 'x' : '\10'));
  const FlightFolder flight = read_flight_folder(out);
  EXPECT_EQ(where_pictures_are(flight), Pictures::kFiles);
  HashCheck hashes;
  const auto pictures = checked(pictures_in_files(flight, 2, 2), flight, hashes);
  for (std::size_t i = 0; i < 3; ++i) (void)pictures(i);
  EXPECT_EQ(hashes.checked, 3u);
  EXPECT_EQ(hashes.others, 1u);
  EXPECT_EQ(hashes.first_other, 1u);
}

TEST_F(Recording, ALostSampleIsAnEmptyCell) {
  FlightRecorder recorder(folder_.path() / "flight");
  Sensors sensors;
  sensors.imu.gyro_B.x() = std::numeric_limits<double>::quiet_NaN();
  recorder.record({.sensors = sensors, .command = {}, .pilot = pilot_, .truth = {}, .frame = {}});
  recorder.finish("{}");
  EXPECT_TRUE(std::isnan(read_flight_folder(folder_.path() / "flight").samples[0].imu.gyro_B.x()));
}

TEST_F(Recording, AnUnfinishedFlightLeavesNothing) {
  {
    FlightRecorder recorder(folder_.path() / "flight");
    record(recorder, 0);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Recording, ReplacesAnEarlierFlightButNothingElse) {
  const auto out = folder_.path() / "flight";
  for (int i = 0; i < 2; ++i) {
    FlightRecorder recorder(out);
    record(recorder, i);
    if (i == 0) recorder.add_file("config-0.toml", "");
    const std::string said = recorder.finish("{\"gates_passed\":" + std::to_string(i) + "}");
    EXPECT_EQ(said, i == 0 ? "" : "in place of the flight that was there");
    if (i == 0) files::write_file(out / "notes.txt", "mine");
  }
  EXPECT_EQ(files::read_file(out / "summary.json"), "{\"gates_passed\":1}");
  EXPECT_FALSE(std::filesystem::exists(out / "config-0.toml"));
  EXPECT_EQ(files::read_file(out / "notes.txt"), "mine");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);

  std::filesystem::remove(out / "summary.json");
  EXPECT_THAT(test::error_of([&] { FlightRecorder{out}; }), HasSubstr("no earlier flight"));
  const auto file = folder_.file("file", "x");
  EXPECT_THAT(test::error_of([&] { FlightRecorder{file}; }), HasSubstr("no folder"));
  EXPECT_THAT(test::error_of([&] { FlightRecorder{file / "below"}; }),
              HasSubstr("cannot be written"));
  EXPECT_THAT(test::error_of([] { FlightRecorder{"."}; }), HasSubstr("--out"));
}

TEST_F(Recording, AFilmThatNoNewOneReplacesGetsANameOfItsOwn) {
  const auto out = folder_.path() / "flight";
  for (int i = 0; i < 3; ++i) {
    FlightRecorder recorder(out);
    if (i < 2) files::write_file(recorder.place_for("flight.mp4"), std::to_string(i));
    recorder.finish("{\"gates_passed\":1}");
  }
  EXPECT_EQ(files::read_file(out / "flight-before-1.mp4"), "1");
  EXPECT_FALSE(std::filesystem::exists(out / "flight.mp4"));
}

TEST_F(Recording, AFlightThatCannotTakeItsPlaceIsKeptAside) {
  const auto out = folder_.path() / "flight", aside = folder_.path() / "flight.partial";
  {
    FlightRecorder recorder(out);
    (void)folder_.file("flight", "came meanwhile");
    EXPECT_THAT(test::error_of([&] { recorder.finish("{}"); }),
                HasSubstr("this flight is in " + aside.string()));
  }
  EXPECT_EQ(files::read_file(aside / "summary.json"), "{}");
  EXPECT_EQ(files::read_file(out), "came meanwhile");
}

TEST(FlightFolder, ReadsRealLogsColumns) {
  const test::TempFolder folder;
  (void)folder.file("log_si.csv", std::string{kRealHeader} +
                                      "0.000606,1,2,3,4,5,6,.1,.2,.3,7,8,9,10,11,12\n"
                                      "0.002560,1,2,3,4,5,6,.1,.2,.3,7,8,9,10,11,12\n");
  (void)folder.file("images.csv", "image,t_s,log_row\nimg_00000.jpg,0.00256,1\n");
  const FlightFolder flight = read_flight_folder(folder.path());
  ASSERT_EQ(flight.samples.size(), 2u);
  EXPECT_EQ(flight.samples[1].time.count(), 2'560'000);
  EXPECT_EQ(flight.samples[0].true_v_E, Eigen::Vector3d(10, 11, 12));
  EXPECT_DOUBLE_EQ(flight.samples[0].ahrs->pitch, 0.2);
  EXPECT_FALSE(flight.samples[0].true_attitude.has_value());
  EXPECT_EQ(flight.images[0].path, folder.path() / "img_00000.jpg");
}

TEST(FlightFolder, DamageIsNamedByFileAndLine) {
  const test::TempFolder folder;
  const auto error = [&](const std::string& log, const std::string& images) {
    (void)folder.file("log_si.csv", kRealHeader + log);
    (void)folder.file("images.csv", "image,t_s,log_row\n" + images);
    return test::error_of([&] { (void)read_flight_folder(folder.path()); });
  };
  const std::string row = ",1,2,3,4,5,6,.1,.2,.3,7,8,9,10,11,12\n";
  EXPECT_THAT(error("", ""), HasSubstr("has no rows"));
  EXPECT_THAT(error("2" + row + "1" + row, ""), HasSubstr("log_si.csv:3: time runs backwards"));
  EXPECT_THAT(error(row, ""), HasSubstr("log_si.csv:2: has no usable time"));
  EXPECT_THAT(error("1" + row, "a.jpg,1,1\n"), HasSubstr("images.csv:2: log_row"));
  EXPECT_THAT(error("1" + row, "a.jpg,1,0.5\n"), HasSubstr("images.csv:2: log_row"));
  EXPECT_THAT(error("1" + row, "../a.jpg,1,0\n"), HasSubstr("images.csv:2: image"));
  const auto late = [&](const std::string& cell) {
    (void)folder.file("log_si.csv", kRealHeader + ("1" + row));
    (void)folder.file("images.csv", "image,t_s,log_row,late_ns\na.jpg,1,0," + cell + "\n");
    return test::error_of([&] { (void)read_flight_folder(folder.path()); });
  };
  for (const char* const cell : {"-1", "2e9", "soon"})
    EXPECT_THAT(late(cell), HasSubstr("images.csv:2")) << cell;
  for (const char* const cell : {"", "0", "1000000000"}) EXPECT_EQ(late(cell), "") << cell;
  EXPECT_THAT(error("1" + row, "a.jpg,1.09,0\n"), "");
  EXPECT_THAT(error("1" + row, "a.jpg,1,0\na.jpg,1,0\n"),
              HasSubstr("images.csv:3: image = 'a.jpg', a second time"));
  EXPECT_THAT(error("1" + row, "a.jpg,1.2,0\n"), HasSubstr("images.csv:2: came at 1.2 s"));
  EXPECT_THAT(test::error_of([] { (void)read_flight_folder("/nowhere"); }),
              HasSubstr("/nowhere: is no folder"));
}

}  // namespace
}  // namespace gatefly::flight_log
