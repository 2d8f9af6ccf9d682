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
void label(TwinPicture& to, const simulated_race::Picture& picture, double bar_share,
           sim::Stream& noise) {
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
  const auto folder = data_folder("tudelft_bebop_gates", options) / room.set;
  LabelledSet set(folder);
  const auto list = folder / "unlabelled_gates.csv";
  const auto unlabelled = std::filesystem::exists(list)
                              ? unlabelled_gates(set, list)
                              : std::vector<std::vector<Quad>>(set.size());
  std::vector<TwinPicture> pictures;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const files::LabelledPicture& row = set.labels.pictures[i];
    if (!row.first_identical.empty() && row.first_identical != row.image) continue;
    pictures.push_back({.name = row.image,
                        .file = std::move(set.files[i]),
                        .gate = {},
                        .others = unlabelled[i],
                        .seed = i / 50});
    if (!row.gates.empty()) pictures.back().gate = row.gates.front();
  }
  return pictures;
}

std::vector<TwinPicture> rendered_pictures(const TwinRoom& room, const TwinOrder& twin_order,
                                           const Options& options) {
  const simulated_race::RaceMaker maker({.config = {.configs = {}, .settings = room.settings},
                                         .track = room.track,
                                         .vision = "rendered",
                                         .laps = 1});
  const simulated_race::PictureOrder order{.pictures = twin_order.seeds * twin_order.per_seed,
                                           .per_seed = twin_order.per_seed,
                                           .first_seed = twin_order.first_seed,
                                           .around = 0.0,
                                           .shake = room.shake_deg * kDegree,
                                           .without_gates = twin_order.without_gates};
  const simulated_race::Race race = maker.race(order.first_seed);
  const world::CameraTruth& camera = race.config.sim.camera;
  const world::WorldGate& gate = race.config.sim.world.gates.front();
  std::vector<TwinPicture> pictures(order.pictures);
  in_parallel(twin_order.seeds, [&](std::size_t nth) {
    const auto stop = [&options] {
      if (options.stopped()) throw Stopped{};
    };
    sim::Stream noise{order.first_seed + nth, "labels"};
    const auto keep = [&](simulated_race::Picture&& picture) {
      TwinPicture& to = pictures[picture.number];
      to.name = "seed " + std::to_string(picture.seed);
      to.seed = picture.seed;
      const Image stored{picture.uyvy.data(), PixelFormat::kUyvy, camera.stored_width,
                         camera.stored_height, 0};
      to.file = files::decoded_jpeg(to.name, files::recorded_jpeg(stored, room.recording));
      label(to, picture, race.config.sim.world.paint.part_of(gate.bar) * gate.bar / gate.side,
            noise);
      return true;
    };
    simulated_race::render_seed(maker, order, nth, keep, stop);
  });
  return pictures;
}

}  // namespace gatefly::experiments
