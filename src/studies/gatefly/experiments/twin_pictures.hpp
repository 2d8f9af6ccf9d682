// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/jpeg_writer.hpp"

namespace gatefly::experiments {

/// A picture of a room, real or rendered.
struct TwinPicture {
  std::string name;
  files::ImageFile file;
  std::optional<Quad> gate;  ///< The one to fly through, all corners in view: middle of the bars.
  std::vector<Quad> others;  ///< Gates where a detection is no mistake.
  std::uint64_t seed = 0;    ///< Seed of its light; 50 rows of a real set.

  [[nodiscard]] Image view() const { return file.view(90); }
};

/// A real room and what stands for it.
struct TwinRoom {
  std::string set;                    ///< Folder of tudelft_bebop_gates.
  std::string config;                 ///< Our detector's.
  std::string track;                  ///< Track on which the rendered poses are flown.
  files::Recording recording{};       ///< How the real pictures were kept; the rendered ones, too.
  double shake_deg = 0.0;             ///< How the camera was held: tasks::PictureOrder.
  std::vector<std::string> settings;  ///< Its look, as --set has them.
};

/// The real pictures, identical ones once, without degenerate labels.
/// @throws std::runtime_error one line: data that is missing or wrong.
[[nodiscard]] std::vector<TwinPicture> real_pictures(const TwinRoom& room, const Options& options);

/// How many are rendered.
struct TwinOrder {
  std::uint64_t first_seed = 1001;
  std::size_t seeds = 30, per_seed = 20;
  bool without_gates = false;
};

/// Rendered ones through the real ones' recording, on all cores.
///
/// Poses are those of ideal races, which no look changes. Labels get the noise of clicks.
/// @throws Stopped.
[[nodiscard]] std::vector<TwinPicture> rendered_pictures(const TwinRoom& room,
                                                         const TwinOrder& order,
                                                         const Options& options);

}  // namespace gatefly::experiments
