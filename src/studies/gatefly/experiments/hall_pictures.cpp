// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/hall_pictures.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/simulated_race/labelled_pictures.hpp"

namespace gatefly::experiments {
namespace {

// Focal lengths for 130, 150, 170 degrees across [cameras/wide-usb.toml].
constexpr std::array kFocalPx{282.1, 244.5, 215.7};
constexpr double kAround = 0.5;   // part of the pictures from anywhere in the hall
constexpr double kNoArea = 16.0;  // an edge-on gate is a line, not a quad [px²]

tasks::ConfigArguments arguments_of(const HallCamera& camera, std::uint64_t seed) {
  const std::string focal = files::text_of(kFocalPx[seed % kFocalPx.size()]);
  tasks::ConfigArguments given{.configs = {"cameras/wide-usb.toml"},
                               .settings = {"camera.focal_px=[" + focal + ", " + focal + "]"}};
  if (camera.level != HallCamera::Level::kRace)
    given.settings.emplace_back("randomize.level=\"hard\"");
  if (camera.straight)
    for (const char* setting : {"camera.model=\"pinhole\"", "camera.distortion=[]"})
      given.settings.emplace_back(setting);
  return given;
}

files::PictureToScore truth_of(const simulated_race::Picture& picture) {
  files::PictureToScore truth;
  for (const sim::GateView& gate : picture.gates) {
    const double area = files::polygon_area(gate.corners_px);
    if (gate.whole && std::sqrt(area) >= HallPicture::kLeastSide)
      truth.gates.push_back(gate.corners_px);
    else if (area > kNoArea)
      truth.ignored.push_back(gate.corners_px);
  }
  return truth;
}

}  // namespace

HallSeed hall_seed(const HallCamera& camera, std::uint64_t seed, std::size_t pictures,
                   const Options& options) {
  const tasks::ConfigArguments given = arguments_of(camera, seed);
  HallSeed hall{.seed = seed, .config = tasks::load(given), .pictures = {}};
  const simulated_race::RaceMaker maker(
      {.config = given, .track = "exhibition", .vision = "rendered", .laps = 1});
  const simulated_race::PictureOrder order{.pictures = pictures,
                                           .per_seed = pictures,
                                           .first_seed = seed,
                                           .around = kAround,
                                           .varied = camera.level == HallCamera::Level::kVaried};
  const auto stop = [&options] {
    if (options.stopped()) throw Stopped{};
  };
  const auto keep = [&](simulated_race::Picture&& picture) {
    const config::CameraDescription& size = hall.config.camera;
    hall.pictures.push_back(
        {.name = std::to_string(seed) + " #" + std::to_string(picture.number),
         .file = {std::move(picture.uyvy), PixelFormat::kUyvy, size.width, size.height},
         .truth = truth_of(picture)});
    return true;
  };
  simulated_race::render_seed(maker, order, 0, keep, stop);
  return hall;
}

}  // namespace gatefly::experiments
