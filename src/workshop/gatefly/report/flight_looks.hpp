// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/report/page_course.hpp"
#include "gatefly/report/page_film.hpp"
#include "gatefly/report/page_tick.hpp"

namespace gatefly::report {

/// Outcome of one picture.
struct Look {
  double time = 0.0, exposed = 0.0;  ///< Arrival, begin of the exposure [s].
  std::optional<double> took = {};   ///< Wall-clock of the pilot's step with it [s].
  int target = 0;
  double distance = 0.0;  ///< To the target where it really stands [m].
  Sighting sighting;
  std::string jpeg;                   ///< The picture; "" when it is left out.
  std::optional<std::size_t> filmed;  ///< Its number in the film.
  /// Error of the fix in the frame of its gate: truth less fix [m].
  std::optional<Eigen::Vector3d> fix_error;
};
/// Pictures and their outcomes, one by one: at most 4000, thinned as they come;
/// the pictures themselves as a film, or some of them as JPEGs.
class FlightLooks {
 public:
  /// @param film  where the film may grow; "": JPEGs.
  explicit FlightLooks(std::filesystem::path film) : film_{std::move(film)} {}

  /// A tick with a picture. @param now  its time [s].
  void add(const PageTick& tick, const PageCourse& course, const RacePlan& plan, double now);

  [[nodiscard]] std::span<const Look> all() const { return looks_; }
  /// Every look; every `picture_step`-th JPEG has its number among jpegs().
  [[nodiscard]] nlohmann::ordered_json json(std::size_t picture_step) const;
  /// The JPEGs as a list of base64.
  [[nodiscard]] std::string jpegs(std::size_t picture_step) const;
  [[nodiscard]] PageFilm& film() { return film_; }
  [[nodiscard]] int picture_width() const { return picture_width_; }  ///< Upright [px].
  [[nodiscard]] int picture_height() const { return picture_height_; }

 private:
  void take_picture(Look& look, const Image& image);

  std::vector<Look> looks_;
  std::size_t looks_seen_ = 0, look_step_ = 1;
  std::size_t jpeg_bytes_ = 0, jpegs_seen_ = 0, jpeg_step_ = 1;
  int picture_width_ = 0, picture_height_ = 0;
  PageFilm film_;
};

}  // namespace gatefly::report
