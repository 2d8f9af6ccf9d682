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
  io::ImageFile file;
  std::optional<Quad> gate;  ///< The one to fly through, all corners in view: middle of the bars.
  std::vector<Quad> others;  ///< Gates where a detection is no mistake.
  std::uint64_t day = 0;     ///< Whose light it has: a seed, or a real recording's part.

  [[nodiscard]] Image view() const { return file.view(90); }
};

/// A real room and what stands for it.
struct TwinRoom {
  const char* name;
  std::vector<const char*> real;  ///< Sets of tudelft_bebop_gates.
  const char *track, *look;
  io::Recording recording;  ///< How the real pictures were kept, and the rendered ones are.
  double shake_deg;         ///< How a hand holds the camera: tasks::PictureOrder.
  const char* config;       ///< Our detector's.
};

/// The real pictures, identical ones once, without degenerate labels.
/// @throws std::runtime_error one line: data that is missing or wrong.
[[nodiscard]] std::vector<TwinPicture> real_pictures(const TwinRoom& room, const Options& options);

/// Rendered ones of `days` seeds from `first_seed`, through the real ones' recording, on all cores.
///
/// Poses are those of ideal races, which no look changes; `roll_deg` adds pictures from around the
/// room. Labels get the noise of the real ones' clicks.
/// @param settings  as --set has them.
[[nodiscard]] std::vector<TwinPicture> rendered_pictures(const TwinRoom& room,
                                                         std::uint64_t first_seed, std::size_t days,
                                                         std::size_t per_day,
                                                         const std::vector<std::string>& settings,
                                                         const Options& options);

}  // namespace gatefly::experiments
