// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/files/film_pipe.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::report {

/// The camera's view as one small film for a page: VP8 in WebM, every picture of the flight.
///
/// Picture i is shown from i / kRate to (i + 1) / kRate seconds, whenever it arrived: who knows the
/// number finds the picture.
class OnboardFilm {
 public:
  static constexpr int kRate = 20;                      ///< Pictures a second of the film.
  static constexpr std::size_t kMostBytes = 2'350'000;  ///< 3.1 MB as base64

  /// Whether there is an ffmpeg that can do it.
  [[nodiscard]] static bool possible();

  /// @param path     where it grows; removed in the end.
  /// @param first    as large as all that follow; larger ones than 320 px are drawn smaller.
  /// @param pictures  how many there will be, about: what each may cost.
  /// @throws std::runtime_error when ffmpeg cannot be started.
  OnboardFilm(std::filesystem::path path, const Image& first, double pictures);

  /// The next picture; one of another size is refused. @throws std::runtime_error
  void add(const Image& picture);

  /// The whole film, at most kMostBytes. @throws std::runtime_error with ffmpeg's own words.
  [[nodiscard]] std::string finish();

 private:
  /// Encodes once more, coarser. @return the bytes
  [[nodiscard]] std::string smaller(double bits_per_second) const;

  std::filesystem::path path_;
  int width_, height_, step_;  ///< Size of the film, even [px]; every step_-th pixel is taken.
  int from_width_, from_height_;
  double bits_per_second_;
  files::FilmPipe file_;
  std::vector<std::uint8_t> bytes_;  ///< One picture's: Y, then U, then V.
};

}  // namespace gatefly::report
