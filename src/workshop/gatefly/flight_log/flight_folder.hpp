// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::flight_log {

/// One row of a flight's log_si.csv. What the log does not have is empty.
struct FlightSample {
  std::chrono::nanoseconds time{0};
  Imu imu;
  std::optional<double> sonar = std::nullopt;               ///< [m]
  std::optional<double> baro = std::nullopt;                ///< [m]
  std::optional<Eigen::Vector3d> true_p_EB = std::nullopt;  ///< Motion capture or simulator [m].
  std::optional<Eigen::Vector3d> true_v_E = std::nullopt;   ///< [m/s]
  std::optional<Attitude> true_attitude = std::nullopt;     ///< Simulator only.
  std::optional<Attitude> ahrs = std::nullopt;              ///< The autopilot's own, in real logs.
  std::optional<double> thrust = std::nullopt;  ///< Asked for by the autopilot; real logs.
  std::optional<Eigen::Vector3d> est_p_EB = std::nullopt;  ///< The recorded pilot's [m].
  std::optional<Eigen::Vector3d> est_v_E = std::nullopt;   ///< [m/s]
  std::optional<Attitude> est_attitude = std::nullopt;
  /// Commanded rotor speeds [rad/s]: left front, right front, right back, left back.
  std::optional<std::array<double, 4>> motors = std::nullopt;
  std::optional<double> battery_v = std::nullopt;  ///< [V]; simulator only.
  /// The sample that an autopilot handed to the estimator in this tick, if one did.
  std::optional<Imu> navigation_imu = std::nullopt;
  /// Whether the drone that another pilot flew had taken off; of runs of a real drone.
  std::optional<bool> lifted = std::nullopt;
};

/// One row of images.csv.
struct FlightImage {
  std::filesystem::path path;
  std::chrono::nanoseconds time{0};  ///< Arrival: the log row's time in our own flights.
  std::size_t log_row = 0;           ///< From 0: the sample in whose tick it arrives.
  /// So much later than the camera's latency says it arrived, by its stamp; 0: unknown.
  std::chrono::nanoseconds late{0};
  std::optional<std::uint64_t> xxh64 = std::nullopt;  ///< Hash of its bytes; our own flights.
  /// True corners of the next gate in it [px, upright], where it shows that gate whole and
  /// unhidden; our own flights.
  std::optional<Quad> next_gate_px = std::nullopt;
};

struct FlightFolder {
  std::filesystem::path directory;
  std::filesystem::path log;          ///< log_si.csv or log_si.csv.gz.
  std::vector<FlightSample> samples;  ///< Ascending in time.
  std::vector<FlightImage> images;    ///< Ascending in log_row.
};

/// Columns of images.csv that say where the next gate really is: top left, top right, bottom right,
/// bottom left.
inline constexpr std::array<const char*, 8> kNextGateColumns{
    "next_tl_u_px", "next_tl_v_px", "next_tr_u_px", "next_tr_v_px",
    "next_br_u_px", "next_br_v_px", "next_bl_u_px", "next_bl_v_px"};

/// Columns of log_si.csv for FlightSample::navigation_imu; empty in ticks without.
inline constexpr std::array<const char*, 6> kNavigationImuColumns{
    "nav_gyro_p_radps", "nav_gyro_q_radps", "nav_gyro_r_radps",
    "nav_acc_x_mps2",   "nav_acc_y_mps2",   "nav_acc_z_mps2"};

/// Column of log_si.csv for FlightSample::lifted.
inline constexpr const char* kLiftedColumn = "lifted";

/// Column of images.csv for FlightImage::late [ns].
inline constexpr const char* kLateColumn = "late_ns";

/// A file in folders of `gatefly record`, which are read as far as they go: power goes when it likes.
inline constexpr const char* kRecordingMark = "recording.json";

/// The frames of a flight in one film without loss.
inline constexpr const char* kFrameFilm = "frames.mkv";

/// The log in a folder: log_si.csv, or log_si.csv.gz where only that is there (who unpacks it may edit
/// it); nullopt when it has neither.
[[nodiscard]] std::optional<std::filesystem::path> log_in(const std::filesystem::path& directory);

/// Reads log_si.csv, or log_si.csv.gz where that is not there, and images.csv, if there is one; real
/// logs' columns or ours. Pictures stay on disk.
/// @throws std::runtime_error one line with file and line: unreadable, damaged, time runs
///     backwards.
[[nodiscard]] FlightFolder read_flight_folder(const std::filesystem::path& directory);

}  // namespace gatefly::flight_log
