// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/twin_pictures.hpp"

#include <algorithm>
#include <utility>

#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/files/scoring.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/simulated_race/labelled_pictures.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kLabelNoise = 1.7;  // of each coordinate [px; pictures labelled twice]

/// The authors clicked on the middle of the bars; the simulator knows the outer corners.
Quad middle_of_bars(const std::array<Eigen::Vector2d, 4>& outer, double bar_share) {
  const Eigen::Vector2d centre = 0.25 * (outer[0] + outer[1] + outer[2] + outer[3]);
  Quad quad;
  for (std::size_t i = 0; i < 4; ++i) quad[i] = outer[i] + bar_share * (centre - outer[i]);
  return quad;
}

/// The gate to fly is the nearest whole one.
void label(TwinPicture& to, const tasks::Picture& picture, double bar_share, sim::Stream& noise) {
  for (const sim::GateView& gate : picture.gates) {
    Quad quad = middle_of_bars(gate.corners_px, bar_share);
    if (to.gate || !gate.whole) {
      to.others.push_back(quad);
      continue;
    }
    for (Eigen::Vector2d& corner : quad)
      corner += kLabelNoise * Eigen::Vector2d{noise.normal(), noise.normal()};
    to.gate = quad;
  }
}

}  // namespace

std::vector<TwinPicture> real_pictures(const TwinRoom& room, const Options& options) {
  std::vector<TwinPicture> pictures;
  for (const char* name : room.real) {
    const auto folder = data_folder("tudelft_bebop_gates", options) / name;
    LabelledSet set(folder);
    const auto unlabelled_file = folder / "unlabelled_gates.csv";
    const bool has_unlabelled = std::filesystem::exists(unlabelled_file);
    const auto unlabelled = has_unlabelled ? unlabelled_gates(set, unlabelled_file)
                                           : std::vector<std::vector<Quad>>(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) {
      const io::LabelledPicture& l = set.labels.pictures[i];
      if (!l.first_identical.empty() && l.first_identical != l.image) continue;
      if (!l.gates.empty() && io::polygon_area(l.gates.front()) < 1.0) continue;
      TwinPicture picture{.name = std::string{name} + "/" + l.image,
                          .file = std::move(set.files[i]),
                          .gate = {},
                          .others = unlabelled[i],
                          .day = i / 50};
      if (!l.gates.empty()) picture.gate = l.gates.front();
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

std::vector<TwinPicture> rendered_pictures(const TwinRoom& room, std::uint64_t first_seed,
                                           std::size_t days, std::size_t per_day,
                                           const std::vector<std::string>& settings,
                                           const Options& options) {
  const tasks::RaceMaker maker({.config = {.configs = {}, .settings = settings},
                                .track = room.track,
                                .vision = "rendered",
                                .laps = 1});
  const tasks::PictureOrder order{.pictures = days * per_day,
                                  .per_day = per_day,
                                  .first_seed = first_seed,
                                  .around = 0.0,
                                  .shake = room.shake_deg * kDegree};
  const tasks::Race race = maker.race(first_seed);
  const sim::CameraTruth& camera = race.config.sim.camera;
  const sim::WorldGate& gate = race.config.sim.world.gates.front();
  std::vector<TwinPicture> pictures(order.pictures);
  in_parallel(days, [&](std::size_t day) {
    if (options.stopped()) return;
    sim::Stream noise{first_seed + day, "labels"};
    tasks::render_day(maker, order, day, [&](tasks::Picture&& picture) {
      TwinPicture& to = pictures[picture.number];
      to.name = "seed " + std::to_string(picture.seed);
      to.day = picture.seed;
      const Image stored{picture.uyvy.data(), PixelFormat::kUyvy, camera.stored_width,
                         camera.stored_height, 0};
      to.file = io::decoded_jpeg(to.name, io::recorded_jpeg(stored, room.recording));
      label(to, picture, gate.bar / gate.side, noise);
      return !options.stopped();
    });
  });
  if (options.stopped()) throw Stopped{};
  return pictures;
}

}  // namespace gatefly::experiments
