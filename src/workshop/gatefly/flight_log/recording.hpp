// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/files/image_file.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::flight_log {

/// One recorded IMU tick: what the sensors said, and where the drone really was, if the log knows.
struct RecordedTick {
  Sensors sensors;                      ///< Without its image.
  std::optional<std::size_t> picture;   ///< Index of the picture that arrived with it.
  std::optional<Eigen::Vector3d> p_EB;  ///< Truth [m].
  /// Long before another pilot takes off: the drone stands, and the pilot, who would take off after
  /// its rest, is not asked. As `gatefly run` does it.
  bool held = false;
};

/// Stand-in for the sonar of a log that has no height at all: motion capture's.
struct SonarStandIn {
  double period = 0.0;                 ///< Between two readings [s]; 0: one with each new position.
  std::function<double()> noise = {};  ///< Added to each reading [m]; none when empty.
};

/// A recording as the pilot had it: what each row of the log says, nothing added. Of two pictures in
/// one row the later counts.
/// @throws std::invalid_argument when a picture arrives in a row that is not there.
[[nodiscard]] std::vector<RecordedTick> ticks_of(const FlightFolder& folder);

/// The same, but a log without a single height (sonar or barometer) gets one from its true positions,
/// as a sonar has it: along the body's axis, by the log's attitude; level where it has none.
[[nodiscard]] std::vector<RecordedTick> ticks_of(const FlightFolder& folder,
                                                 const SonarStandIn& sonar);

/// Answers the stored picture `i` of a recording, valid until the next.
using PictureSource = std::function<const files::ImageFile&(std::size_t i)>;

/// Reads each picture from its file.
/// @param folder  must live as long.
/// @param stored_width,stored_height  the camera's [px]: of raw pictures, which do not know it, and
///     what others must have. @throws std::runtime_error one line, when the picture is read.
[[nodiscard]] PictureSource pictures_in_files(const FlightFolder& folder, int stored_width,
                                              int stored_height);

/// Reads them from frames.mkv, in order; one before the last one is found from the start again.
/// @throws std::runtime_error one line: no ffmpeg, damaged, fewer or other pictures than images.csv
///     says.
[[nodiscard]] PictureSource pictures_in_film(const FlightFolder& folder, int stored_width,
                                             int stored_height);

/// Place of a recording's pictures.
enum class Pictures {
  kNone,   ///< It has none.
  kFiles,  ///< Each in its own.
  kFilm,   ///< In frames.mkv.
  kHashes  ///< Not kept: to be rendered again, and compared with their hashes.
};
[[nodiscard]] Pictures where_pictures_are(const FlightFolder& folder);

/// Pictures that are not those of the flight, by their hashes.
struct HashCheck {
  std::size_t checked = 0, others = 0;
  std::optional<std::size_t> first_other;
};

/// Compares each picture with the hash that images.csv has, if it has one.
/// @param folder,check  must live as long.
[[nodiscard]] PictureSource checked(PictureSource source, const FlightFolder& folder,
                                    HashCheck& check);

/// The pictures upright, for replay(): each view is valid until the next.
[[nodiscard]] std::function<Image(std::size_t)> upright(PictureSource source, int rotation_deg);

}  // namespace gatefly::flight_log
