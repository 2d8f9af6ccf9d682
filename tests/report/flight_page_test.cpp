// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/report/page.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::report {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kEmpty = "<body><!--gatefly:flight--></body>";

struct OneGate {
  PilotConfig pilot;
  PageCourse course;
};
OneGate one_gate() {
  OneGate race;
  race.pilot.track.gates = {MapGate{.p_EG = {3, 0, -1.5}}};
  world::SimConfig sim;
  sim.world.gates = {world::WorldGate{.p_EG = {3, 0.1, -1.5}}};
  sim.world.obstacles = {world::WorldBox{}, world::WorldBox{.center = {2, 2}, .pole = true}};
  race.course = page_course(race.pilot, sim, true);
  return race;
}

/// Noise: no JPEG makes it small.
std::vector<std::uint8_t> noise(std::size_t bytes) {
  std::vector<std::uint8_t> all(bytes);
  std::uint32_t state = 1;
  for (auto& byte : all)
    byte = static_cast<std::uint8_t>((state = state * 1664525U + 1013904223U) >> 24);
  return all;
}

/// The body's pose at a time, without any physics: through the gate at 3 s.
flight_log::Truth at(double time) {
  return {.p_EB = {time, 0.15, -1.4}, .v_E = {1, 0, 0}, .attitude = {0.01, 0.02, 0.03}};
}

/// Ticks of 512 Hz; a picture every 0.1 s if there are any. @return the times of all ticks [s]
std::vector<double> fly(FlightPage& page, const OneGate& race, double seconds, bool pictures) {
  const std::vector<std::uint8_t> picture = noise(image_bytes(PixelFormat::kUyvy, 160, 315));
  Pilot pilot{race.pilot};
  std::vector<double> times;
  double next = 0.0;
  for (int i = 0; i < static_cast<int>(seconds * 512); ++i) {
    Sensors sensors;
    sensors.time = std::chrono::nanoseconds{i * 1953125LL};
    sensors.imu.accel_B = {0, 0, -9.81};
    const double now = 1e-9 * static_cast<double>(sensors.time.count());
    if (pictures && now >= next) {
      sensors.image = Image(picture.data(), PixelFormat::kUyvy, 160, 315, 90);
      next += 0.1;
    }
    const Command command = pilot.step(sensors);
    const flight_log::Tick tick{sensors, command, pilot, at(now), {}, now - 0.05};
    page.record(tick);
    if (i + 1 == static_cast<int>(seconds * 512)) page.end(tick);
    times.push_back(now);
  }
  return times;
}

Json element(const std::string& html, const std::string& id) {
  const std::string begin = "id=\"" + id + "\">";
  const std::size_t from = html.find(begin) + begin.size();
  return Json::parse(html.substr(from, html.find("</script>", from) - from));
}

std::vector<double> column(const Json& flight, const std::string& name) {
  std::vector<double> values;
  std::int64_t sum = 0;
  const Json& column = flight["columns"][name];
  for (const std::int64_t step : column["steps"])
    values.push_back(static_cast<double>(sum += step) * column["unit"].get<double>());
  return values;
}

Json summary(int passed) {
  return {{"gates_passed", passed}, {"gates_total", 1}, {"gate_offsets_m", {{0.05, 0.1}}}};
}

TEST(FlightPageTest, WhatWasRecordedIsReadBack) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  const std::vector<double> times = fly(page, race, 4.0, false);
  const Json flight = element(page.html(summary(1), "finished"), "flight");

  const std::vector<double> t = column(flight, "t_s"), x = column(flight, "x_m"),
                            yaw = column(flight, "yaw_rad"), error = column(flight, "error_y_m"),
                            spread = column(flight, "l_xx_m"), phase = column(flight, "phase");
  ASSERT_EQ(t.size(), x.size());
  EXPECT_NEAR(static_cast<double>(t.size()), 4.0 * 50, 8);
  EXPECT_NEAR(t.back(), times.back(), 1e-4) << "to the very last tick: the contact";
  for (std::size_t i = 0; i < t.size(); ++i) {
    ASSERT_NEAR(x[i], at(t[i]).p_EB.x(), 7e-4);
    ASSERT_NEAR(yaw[i], 0.03, 6e-5);
    ASSERT_TRUE(spread[i] > 0.0);
  }
  EXPECT_EQ(phase.front(), 0.0);
  EXPECT_EQ(flight["phases"][0], "ground");
  EXPECT_TRUE(std::isfinite(error.back()));
  EXPECT_EQ(flight["course"]["gates"][0]["position"], Json::parse("[3.0, 0.1, -1.5]"));
  EXPECT_EQ(flight["course"]["gates"][0]["map"]["position"], Json::parse("[3.0, 0.0, -1.5]"));
  EXPECT_EQ(flight["course"]["plan"].size(), 1U) << "from the start to the only gate";
}

TEST(FlightPageTest, RotorsAtTheirLimitBetweenTwoRowsAreCounted) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  Pilot pilot{race.pilot};
  const auto [lowest, highest] = race.course.rotor_limits;
  // A row each 20 ms, a tick each 2 ms: at 24 ms a rotor is at its upper limit, at 44 ms at its lower.
  for (int ms = 0; ms <= 100; ms += 2) {
    Sensors sensors;
    sensors.time = std::chrono::milliseconds{ms};
    sensors.imu.accel_B = {0, 0, ms == 24 ? -19.0 : -9.0};
    Command command;
    command.motors = {800, 810, 820, 830};
    if (ms == 24) command.motors[1] = highest;
    if (ms == 44) command.motors[2] = lowest;
    PageTick tick{.sensors = sensors, .command = command, .pilot = pilot};
    tick.battery_v = 12.0 - 0.01 * ms;
    page.record(tick);
  }
  const Json flight = element(page.html(summary(0), "crashed"), "flight");
  const std::vector<double> fastest = column(flight, "rotor_fastest_radps"),
                            slowest = column(flight, "rotor_slowest_radps"),
                            share = column(flight, "rotor_saturated"),
                            thrust = column(flight, "thrust_mps2"),
                            battery = column(flight, "battery_v");
  ASSERT_EQ(share.size(), 6U) << "0, 20, .. 100 ms";
  EXPECT_THAT(share, testing::Pointwise(testing::DoubleNear(1e-9), {0.0, 0.0, 0.1, 0.1, 0.0, 0.0}));
  EXPECT_NEAR(fastest[2], highest, 0.06);
  EXPECT_NEAR(fastest[3], 830.0, 0.06);
  EXPECT_NEAR(slowest[3], lowest, 0.06);
  EXPECT_NEAR(thrust[2], 10.0, 6e-4) << "the mean of ten samples";
  EXPECT_NEAR(battery.back(), 11.0, 6e-4);
  EXPECT_EQ(flight["course"]["rotor_limits_radps"], Json::array({lowest, highest}));
}

TEST(FlightPageTest, WhyTheRaceWasLostIsHandedOn) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  Json told = summary(0);
  EXPECT_TRUE(element(page.html(told, "finished"), "flight")["why"].is_null());
  told["why_lost"] = {{"line", "Lost at gate 1: </script>"}, {"t_s", 1.5}};
  EXPECT_EQ(element(page.html(told, "crashed"), "flight")["why"], told["why_lost"]);
}

TEST(FlightPageTest, APassHasItsTimeSpeedAndOffset) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  fly(page, race, 4.0, false);
  const Json passes = element(page.html(summary(1), "finished"), "flight")["passes"];
  ASSERT_EQ(passes.size(), 1U);
  EXPECT_NEAR(passes[0]["t"].get<double>(), 3.0, 1e-3);
  EXPECT_NEAR(passes[0]["speed"].get<double>(), 1.0, 1e-3);
  EXPECT_EQ(passes[0]["offset"], Json::parse("[0.05, 0.1]"));
}

TEST(FlightPageTest, AFlightThatEndsBeforeItsFirstTickOrItsGateHasAPage) {
  const auto race = one_gate();
  FlightPage empty(kEmpty, race.course);
  EXPECT_TRUE(
      element(empty.html(summary(0), "not finished"), "flight")["columns"]["t_s"]["steps"].empty());

  FlightPage page(kEmpty, race.course);
  fly(page, race, 1.0, true);
  const Json passes = element(page.html(summary(0), "crashed"), "flight")["passes"];
  ASSERT_EQ(passes.size(), 1U) << "the gate that it did not reach";
  EXPECT_FALSE(passes[0].contains("t"));
}

TEST(FlightPageTest, PicturesAreJpegsAndNamedByTheirLook) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  fly(page, race, 1.0, true);
  const std::string html = page.html(summary(0), "crashed");
  const Json pictures = element(html, "pictures"), looks = element(html, "flight")["looks"];
  ASSERT_EQ(looks.size(), 10U);
  ASSERT_EQ(pictures.size(), 10U);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    EXPECT_EQ(looks[i]["picture"], i);
    EXPECT_NEAR(looks[i]["t"].get<double>(), 0.1 * static_cast<double>(i), 2.1e-3);
    EXPECT_NEAR(looks[i]["t"].get<double>() - looks[i]["exposed"].get<double>(), 0.05, 2e-4);
    EXPECT_EQ(pictures[i].get<std::string>().substr(0, 4), "/9j/");  // FF D8 FF in base64
  }
}

TEST(FlightPageTest, ALongFlightIsThinnedToTheLargestPage) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  fly(page, race, 150.0, true);  // of noise, which no JPEG makes small
  const std::string html = page.html(summary(1), "finished");
  EXPECT_LE(html.size(), FlightPage::kMostBytes);
  const Json pictures = element(html, "pictures"), flight = element(html, "flight");
  EXPECT_GT(pictures.size(), 40U);
  std::size_t next = 0;
  for (const Json& look : flight["looks"]) {
    if (look.contains("picture")) {
      EXPECT_EQ(look["picture"], next++);
    }
  }
  EXPECT_EQ(next, pictures.size());
  const std::vector<double> t = column(flight, "t_s");
  EXPECT_LE(t.size(), 6001U);
  EXPECT_GT(t.size(), 2900U);
  EXPECT_TRUE(std::is_sorted(t.begin(), t.end()));
}

TEST(FlightPageTest, EveryPictureIsInTheFilmUnderItsNumber) {
  if (!OnboardFilm::possible()) GTEST_SKIP() << "no ffmpeg with VP8 here";
  const test::TempFolder folder;
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course, folder.path() / "onboard.webm");
  fly(page, race, 6.0, true);
  const std::string html = page.html(summary(1), "finished");
  const Json flight = element(html, "flight");
  ASSERT_EQ(flight["film"]["pictures"], 60);
  for (std::size_t i = 0; i < flight["looks"].size(); ++i)
    EXPECT_EQ(flight["looks"][i]["picture"], i);
  EXPECT_THAT(html, HasSubstr("id=\"film\">GkXfo")) << "WebM: 1A 45 DF A3";
  EXPECT_EQ(element(html, "pictures").size(), 0U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing is left behind";
}

TEST(FlightPageTest, AFilmThatCannotGrowIsSaidAndTheFlightHasItsPage) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course, "/nowhere/onboard.webm");
  fly(page, race, 1.0, true);
  const Json flight = element(page.html(summary(0), "crashed"), "flight");
  EXPECT_EQ(flight["film_failed"], true);
  EXPECT_FALSE(flight.contains("film"));
}

TEST(OnboardFilmTest, IsNeverLargerThanItMayBe) {
  if (!OnboardFilm::possible()) GTEST_SKIP() << "no ffmpeg with VP8 here";
  const test::TempFolder folder;
  const std::vector<std::uint8_t> bytes = noise(image_bytes(PixelFormat::kUyvy, 160, 315));
  const Image picture(bytes.data(), PixelFormat::kUyvy, 160, 315, 90);
  OnboardFilm film(folder.path() / "film.webm", picture, 10);  // there will be thirty times as many
  for (int i = 0; i < 300; ++i) film.add(picture);
  EXPECT_LE(film.finish().size(), OnboardFilm::kMostBytes);
}

TEST(FlightPageTest, WhatNobodyKnowsIsLeftOut) {
  const auto race = one_gate();
  FlightPage page(kEmpty, page_course(race.pilot));
  Pilot pilot{race.pilot};
  for (int i = 0; i < 512; ++i) {
    Sensors sensors;
    sensors.time = std::chrono::nanoseconds{i * 1953125LL};
    sensors.imu.accel_B = {0, 0, -9.81};
    const Command command = pilot.step(sensors);
    PageTick tick{.sensors = sensors, .command = command, .pilot = pilot};
    if (i >= 256) tick.p_EB = Eigen::Vector3d{1, 2, -1};
    page.record(tick);
  }
  const Json flight = element(page.html(summary(0), "replayed"), "flight");
  EXPECT_FALSE(flight["columns"].contains("vx_mps"));
  EXPECT_FALSE(flight["columns"].contains("wind_north_mps"));
  EXPECT_TRUE(flight["columns"]["x_m"]["steps"].front().is_null());
  int sum = 0;
  for (const Json& step : flight["columns"]["x_m"]["steps"])
    sum += step.is_null() ? 0 : step.get<int>();
  EXPECT_EQ(sum, 1000) << "the first that is known counts from zero";
  EXPECT_FALSE(flight["course"]["gates"][0].contains("map")) << "the map is all there is";
}

TEST(FlightPageTest, NoTextEndsTheElementItStandsIn) {
  const auto race = one_gate();
  FlightPage page(kEmpty, race.course);
  Json told = summary(0);
  told["track"] = "</script><script>alert(1)</script>\xff";
  const std::string html = page.html(told, "</script>");
  EXPECT_THAT(html, Not(HasSubstr("alert(1)</script>")));
  EXPECT_EQ(element(html, "flight")["verdict"], "</script>");
}

TEST(FlightPageTest, AFileThatIsNoPageIsRefused) {
  EXPECT_THAT(shipped_page(), HasSubstr("<!--gatefly:flight-->"));
  EXPECT_THAT(shipped_page("campaign.html"), HasSubstr("<!--gatefly:flight-->"));
  EXPECT_THROW((void)shipped_page("LICENSES.txt"), std::runtime_error);
  EXPECT_THROW((void)files::small_jpeg(Image{}, 50), std::invalid_argument);
}

}  // namespace
}  // namespace gatefly::report
