// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/rendered_again.hpp"

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "gatefly/files/image_file.hpp"
#include "gatefly/simulated_race/closed_loop/frames_again.hpp"
#include "gatefly/simulated_race/race_maker.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

namespace gatefly::simulated_race {
namespace {

struct Renderer {
  Renderer(const tasks::RecordedFlight& f, std::function<void()> w)
      : flight{f},
        while_baking{std::move(w)},
        config{RaceMaker::of_flight(f.folder.directory)
                   .race(tasks::seed_of_flight(f.folder.directory))
                   .config.sim},
        picture{.bytes = {},
                .format = PixelFormat::kUyvy,
                .stored_width = config.camera.stored_width,
                .stored_height = config.camera.stored_height} {
    if (config.autopilot.takes != world::AutopilotTruth::Takes::kNone)
      throw std::runtime_error(
          f.folder.log.string() +
          ": flown by way of an autopilot (control.output), whose rotor speeds "
          "are not in the log: its pictures cannot be rendered again");
    picture.bytes.assign(image_bytes(picture.format, picture.stored_width, picture.stored_height),
                         128);
  }

  const files::ImageFile& operator()(std::size_t i) {
    const std::size_t row = flight.folder.images.at(i).log_row;
    if (!frames || row < frames->ticks())
      frames = std::make_unique<FramesAgain>(
          config, [this](std::size_t tick) { return motors(tick); }, while_baking);
    const auto bytes = frames->picture_of(row);
    // Without one, as another version's camera may have it, the last stays: its hash is another.
    if (!bytes.empty()) picture.bytes.assign(bytes.begin(), bytes.end());
    return picture;
  }

  [[nodiscard]] std::array<double, 4> motors(std::size_t tick) const {
    const auto& speeds = flight.folder.samples.at(tick).motors;
    if (!speeds)
      throw std::runtime_error(flight.folder.log.string() + ":" + std::to_string(tick + 2) +
                               ": has no rotor speeds (motor_lf_radps ...), without which the "
                               "flight's pictures cannot be rendered again");
    return *speeds;
  }

  const tasks::RecordedFlight& flight;
  std::function<void()> while_baking;
  world::SimConfig config;
  files::ImageFile picture;
  std::unique_ptr<FramesAgain> frames;
};

}  // namespace

flight_log::PictureSource rendered_again(const tasks::RecordedFlight& flight,
                                         const std::function<void()>& while_baking) {
  const auto renderer = std::make_shared<Renderer>(flight, while_baking);
  return [renderer](std::size_t i) -> const files::ImageFile& { return (*renderer)(i); };
}

}  // namespace gatefly::simulated_race
