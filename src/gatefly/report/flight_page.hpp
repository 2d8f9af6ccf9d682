// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/closed_loop/race.hpp"

namespace gatefly::io {

/// The page of a flight without the flight: viewer/report.html of what gatefly comes with.
/// @throws std::runtime_error when it is missing or no such page.
[[nodiscard]] std::string shipped_page();

/// A flight as one page for a browser, report.html, collected while it is flown: what was, what the
/// pilot believed and what it saw, each with its time. Collects only; the flight is the same
/// without it.
///
/// Whatever is too much is thinned as it comes, so that a page never outgrows kMostBytes.
class FlightPage {
 public:
  static constexpr std::size_t kMostBytes = 5'000'000;

  /// @param page      shipped_page().
  /// @param pictures  false when the race has none (ideal vision).
  FlightPage(std::string page, const closed_loop::RaceConfig& race, bool pictures);

  /// Every tick of the race, in order.
  void record(const Tick& tick);

  /// @param summary  summary() of the same race.
  /// @param verdict  in words: "crashed into a pole at ...".
  [[nodiscard]] std::string html(const nlohmann::ordered_json& summary,
                                 const std::string& verdict) const;

 private:
  /// Whole numbers of the units in flight_page.cpp: differences of them add up without error.
  static constexpr std::size_t kColumns = 41;
  using Row = std::array<std::int64_t, kColumns>;

  /// What came of one picture.
  struct Look {
    double time = 0.0, exposed = 0.0;  ///< Arrival, begin of the exposure [s].
    int target = 0;
    double distance = 0.0;  ///< To the target where it really stands [m].
    Sighting sighting;
    std::string jpeg;  ///< The picture; "" when it is left out.
  };
  struct Pass {
    double time = 0.0, speed = 0.0;  ///< [s], [m/s]
  };

  void look(const Tick& tick, double now);
  void take_picture(Look& look, const Image& image);
  void follow_truth(const Truth& truth, double now);
  [[nodiscard]] Row row_of(const Tick& tick, double now) const;
  [[nodiscard]] nlohmann::ordered_json course() const;
  [[nodiscard]] nlohmann::ordered_json columns() const;
  [[nodiscard]] nlohmann::ordered_json looks(std::size_t picture_step) const;
  [[nodiscard]] nlohmann::ordered_json gate_passes(const nlohmann::ordered_json& summary) const;
  [[nodiscard]] std::string pictures(std::size_t picture_step) const;

  std::string page_;
  closed_loop::RaceConfig race_;
  bool pictures_wanted_;
  std::optional<RacePlan> plan_;
  std::vector<Row> rows_;
  Row last_{};
  double row_period_ = 0.02, next_row_ = 0.0;  ///< [s]
  std::vector<Look> looks_;
  std::size_t looks_seen_ = 0, look_step_ = 1;
  std::size_t jpeg_bytes_ = 0, jpegs_seen_ = 0, jpeg_step_ = 1;
  int picture_width_ = 0, picture_height_ = 0;  ///< Of the camera, upright [px].
  std::vector<Pass> passes_;
  std::optional<Truth> before_;
  double before_time_ = 0.0;  ///< [s]
};

}  // namespace gatefly::io
