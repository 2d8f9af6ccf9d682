// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/flight_video.hpp"

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::simulated_race {
namespace {

using ::testing::HasSubstr;

RaceConfig one_gate() {
  RaceConfig race;
  race.pilot.track.gates = {MapGate{.p_EG = {3, 0, -1.5}}};
  race.sim.world.gates = {world::WorldGate{.p_EG = {3, 0, -1.5}}};
  race.sim.world.obstacles = {world::WorldBox{}, world::WorldBox{.center = {2, 2}, .pole = true}};
  return race;
}

/// Half a second of standing on the pad, with a grey picture every 0.1 s if there are any.
void record_start(FlightVideo& video, const RaceConfig& race, bool pictures) {
  const std::vector<std::uint8_t> grey(image_bytes(PixelFormat::kUyvy, 160, 315), 128);
  Pilot pilot{race.pilot};
  for (int ms = 0; ms <= 500; ms += 2) {
    Sensors sensors;
    sensors.time = std::chrono::milliseconds{ms};
    if (pictures && ms % 100 == 0)
      sensors.image = Image(grey.data(), PixelFormat::kUyvy, 160, 315, 90);
    const Command command = pilot.step(sensors);
    video.record({sensors, command, pilot, {}, {}});
  }
}

class FlightVideoTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::error_of(files::require_ffmpeg).empty()) GTEST_SKIP() << "there is no ffmpeg";
  }
  test::TempFolder folder_;
};

TEST_F(FlightVideoTest, AFinishedFlightIsAFilmWithOrWithoutPictures) {
  const auto race = one_gate();
  for (const bool pictures : {true, false}) {
    const auto path = folder_.path() / (pictures ? "rendered.mp4" : "ideal.mp4");
    FlightVideo video(path, race, "one gate, seed 1", pictures);
    record_start(video, race, pictures);
    EXPECT_FALSE(std::filesystem::exists(path));
    // Longer than any panel: it has to shrink, not to fail.
    RaceResult result;
    result.lap_times = std::vector<double>(200, 10.0);
    video.finish(result, std::string(300, 'x'));
    EXPECT_THAT(files::read_file(path).substr(0, 12), HasSubstr("ftyp"));
  }
}

TEST_F(FlightVideoTest, AContactIsShownBeforeTheCardCoversIt) {
  const auto race = one_gate();
  const auto path = folder_.path() / "lost.mp4", frame = folder_.path() / "frame.rgb";
  FlightVideo video(path, race, "one gate, seed 1", true);
  record_start(video, race, true);
  RaceResult result;
  result.crash_time = 0.5;
  result.crash_object = "gate 1 left bar";
  video.finish(result, "crashed");
  const auto red_at =
      [&](double seconds) {  // in the middle of the line below the picture, at its left
        const std::string command = "ffmpeg -v error -y -ss " + std::to_string(seconds) + " -i " +
                                    path.string() + " -frames:v 1 -f rawvideo -pix_fmt rgb24 " +
                                    frame.string();
        EXPECT_EQ(std::system(command.c_str()), 0);
        const std::string rgb = files::read_file(frame);
        const std::size_t pixel = 3 * (1600 * (70 + 480 - 22) + 30);
        const auto of = [&](std::size_t i) {
          return static_cast<unsigned char>(rgb.at(pixel + i));
        };
        return of(0) > 200 && of(1) < 160 && of(2) < 160;
      };
  EXPECT_FALSE(red_at(0.2)) << "in flight";
  EXPECT_TRUE(red_at(1.5)) << "held for two seconds";
  EXPECT_FALSE(red_at(4.0)) << "below the dimming of the card";
}

TEST(FlightMap, ShowsTheCourseAsItStandsInColoursOfItsOwn) {
  world::World world;
  world.gates = {world::WorldGate{.p_EG = {3, 0, -1.5}, .color = {0.0, 0.0, 0.4}},
                 world::WorldGate{.p_EG = {5, 0, -2.5}, .color = {0.5, 0.5, 0.5}}};
  world.obstacles = {world::WorldBox{.center = {2, 2}, .top = 1.2, .pole = true}};
  const drawing::Course course = course_of(world);
  EXPECT_EQ(course.gates[0].gate.p_EG, world.gates[0].p_EG);
  EXPECT_EQ(drawing::css_of(course.gates[0].color), "#0000ff") << "as bright as it can be";
  EXPECT_EQ(drawing::css_of(course.gates[1].color), "#ffffff");
  EXPECT_TRUE(course.solids[0].round);
  EXPECT_EQ(course.solids[0].box.height, 1.2);
}

TEST_F(FlightVideoTest, AnInterruptedFlightLeavesNothing) {
  const auto race = one_gate();
  {
    FlightVideo video(folder_.path() / "flight.mp4", race, "one gate, seed 1", true);
    record_start(video, race, true);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace gatefly::simulated_race
