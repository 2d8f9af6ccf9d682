// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/flight_log/tick.hpp"
#include "gatefly/pages/onboard_film.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::io {

/// Where a flight takes place, as a page shows it.
struct PageCourse {
  sim::World world;                  ///< Where everything really stands.
  Track map;                         ///< As the pilot knows it.
  double speed = 1.5;                ///< That the pilot is to fly [m/s].
  double pictures_per_second = 0.0;  ///< 0: there are none.
  std::size_t pictures = 0;          ///< How many there will be, where that is known.
  /// Systematic errors of the IMU in flight, where they are known [m/s²], [rad/s].
  std::optional<Eigen::Vector3d> accel_bias = std::nullopt, gyro_bias = std::nullopt;
  /// The world is the truth, and the referee goes by it; else it is the map, and the pilot counts.
  bool is_truth = true;
};
[[nodiscard]] PageCourse page_course(const PilotConfig& pilot, const sim::SimConfig& sim,
                                     bool pictures);
/// Of a recorded flight: nobody knows where things really stood.
[[nodiscard]] PageCourse page_course(const PilotConfig& pilot);

/// One tick of a flight. What nobody knows is empty.
struct PageTick {
  const Sensors& sensors;
  const Command& command;
  const Pilot& pilot;
  const Estimate* estimate = nullptr;  ///< Another filter's; nullptr: the pilot's.
  std::optional<Eigen::Vector3d> p_EB = std::nullopt, v_E = std::nullopt;  ///< Truth.
  std::optional<Attitude> attitude = std::nullopt;
  std::optional<Eigen::Vector2d> wind_E = std::nullopt;
  std::optional<double> exposed = std::nullopt;  ///< Begin of the picture's exposure [s].
};

/// A flight as one page for a browser, report.html, collected while it is flown: what was, what the
/// pilot believed and what it saw, each with its time. Collects only; the flight is the same
/// without it.
///
/// Whatever is too much is thinned as it comes, so that a page never outgrows kMostBytes.
class FlightPage {
 public:
  static constexpr std::size_t kMostBytes = 5'000'000;

  /// @param page  shipped_page().
  /// @param film  where the onboard film may grow; "": no ffmpeg, so some of the pictures, as JPEGs.
  FlightPage(std::string page, PageCourse course, std::filesystem::path film = {});

  /// Every tick of the flight, in order.
  void record(const Tick& tick);
  void record(const PageTick& tick);

  /// Once, after the last tick.
  /// @param summary  summary() of the same race.
  /// @param verdict  in words: "crashed into a pole at ...".
  [[nodiscard]] std::string html(const nlohmann::ordered_json& summary, const std::string& verdict);

 private:
  /// Whole numbers of the units in flight_page.cpp: differences of them add up without error.
  static constexpr std::size_t kColumns = 54;
  using Row = std::array<std::int64_t, kColumns>;

  /// What came of one picture.
  struct Look {
    double time = 0.0, exposed = 0.0;  ///< Arrival, begin of the exposure [s].
    int target = 0;
    double distance = 0.0;  ///< To the target where it really stands [m].
    Sighting sighting;
    std::string jpeg;                   ///< The picture; "" when it is left out.
    std::optional<std::size_t> filmed;  ///< Its number in the film.
    /// Of the fix, in the frame of its gate: truth less fix [m].
    std::optional<Eigen::Vector3d> fix_error;
  };
  struct Pass {
    double time = 0.0, speed = 0.0;  ///< [s], [m/s]
  };

  void look(const PageTick& tick, double now);
  void take_picture(Look& look, const Image& image);
  void film(Look& look, const Image& image);
  void follow_truth(const Eigen::Vector3d& p_EB, const PageTick& tick, double now);
  void count_gates(const PageTick& tick, double now);
  [[nodiscard]] Row row_of(const PageTick& tick, double now) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> in_target_gate(const PageTick& tick,
                                                              const Eigen::Vector3d& p_EB) const;
  [[nodiscard]] nlohmann::ordered_json course() const;
  [[nodiscard]] std::string columns(std::size_t row_step) const;
  [[nodiscard]] nlohmann::ordered_json looks(std::size_t picture_step) const;
  [[nodiscard]] nlohmann::ordered_json gate_passes(const nlohmann::ordered_json& summary) const;
  [[nodiscard]] std::string pictures(std::size_t picture_step) const;
  [[nodiscard]] double pictures_expected() const;

  std::string page_;
  PageCourse course_;
  std::vector<Eigen::Matrix3d> to_gate_;  ///< Of the world's gates.
  std::filesystem::path film_path_;
  std::optional<OnboardFilm> film_;
  std::string film_bytes_;
  std::size_t filmed_ = 0;
  bool film_failed_ = false;
  std::optional<RacePlan> plan_;
  std::vector<Row> rows_;
  double row_period_ = 0.02, next_row_ = 0.0;  ///< [s]
  std::vector<Look> looks_;
  std::size_t looks_seen_ = 0, look_step_ = 1;
  std::size_t jpeg_bytes_ = 0, jpegs_seen_ = 0, jpeg_step_ = 1;
  int picture_width_ = 0, picture_height_ = 0;  ///< Of the camera, upright [px].
  std::vector<Pass> passes_;
  std::optional<Eigen::Vector3d> before_;
  double before_time_ = 0.0;  ///< [s]
  int passed_ = 0;            ///< As the pilot counts.
};

}  // namespace gatefly::io
