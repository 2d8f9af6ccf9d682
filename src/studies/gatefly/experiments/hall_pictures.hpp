// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {

/// A camera of cameras/wide-usb.toml's kind: 640 x 480, JPEG 4:2:0.
struct HallCamera {
  enum class Level { kRace, kHard, kVaried };  ///< By [randomize] level; as `render --varied`.

  bool straight = false;  ///< A pinhole of the same focal length in the middle.
  Level level = Level::kRace;
};

/// A rendered picture and what it shows.
struct HallPicture {
  std::string name;
  files::ImageFile file;
  /// Whole gates of a side of at least kLeastSide; smaller ones, and those cut or hidden in part, are
  /// ignored.
  files::PictureToScore truth;

  static constexpr double kLeastSide = 25.0;  ///< Square root of the area [px].
  [[nodiscard]] Image view() const { return file.view(0); }
};

/// One seed of the exhibition hall: its own light, exposure, gates and lens.
struct HallSeed {
  std::uint64_t seed = 0;
  config::Config config;  ///< The detector gets the camera file, no more.
  std::vector<HallPicture> pictures;
};

/// Half of the pictures from the racing line, half from anywhere. The lens has 130, 150 or 170
/// degrees across, by seed; the straight one its focal length.
[[nodiscard]] HallSeed hall_seed(const HallCamera& camera, std::uint64_t seed, std::size_t pictures,
                                 const Options& options);

}  // namespace gatefly::experiments
