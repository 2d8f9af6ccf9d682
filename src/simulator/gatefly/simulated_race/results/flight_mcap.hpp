// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "gatefly/flight_log/mcap_writer.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::simulated_race {

/// A flight as flight.mcap, for Foxglove, Lichtblick and whatever reads MCAP; written while it is
/// flown. Looks only; the flight is the same without it. Channels: docs/flight_folder.md.
///
/// Poses and scene are z-up, as viewers want it: north, west, up, the body front, left, up. What is
/// ours (`gatefly.…`) has the axes of the log: north, east, down, and front, right, down.
class FlightMcap {
 public:
  /// @throws std::runtime_error when it cannot be written.
  FlightMcap(const std::filesystem::path& path, const RaceConfig& race);

  /// Every tick of the race, in order. @throws std::runtime_error e.g. disk full.
  void record(const flight_log::Tick& tick);
  /// Completes the file. @throws std::runtime_error e.g. disk full.
  void finish() { writer_.finish(); }

 private:
  void write_scene(const flight_log::Tick& tick, std::uint64_t time);
  void write_state(const flight_log::Tick& tick, std::uint64_t time);
  void write_transforms(const flight_log::Truth& truth, const Estimate& e, std::uint64_t time);
  void write_pose(flight_log::McapWriter::Channel channel, const Eigen::Vector3d& p_EB,
                  const Attitude& attitude, std::uint64_t time);
  void write_truth(const flight_log::Truth& truth, std::uint64_t time);
  void write_estimate(const Estimate& e, int target_gate, std::uint64_t time);
  void write_control(const flight_log::Tick& tick, std::uint64_t time);
  void write_imu(const Imu& imu, std::uint64_t time);
  void write_look(const flight_log::Tick& tick, std::uint64_t time);
  /// @param exposed  begin of the picture's exposure [s].
  void write_detections(const Sighting& sighting, double exposed, std::uint64_t time);
  void write_image(const Image& image, std::uint64_t time);
  void write_annotations(const Sighting& sighting, std::uint64_t time);

  flight_log::McapWriter writer_;
  RaceConfig race_;
  flight_log::McapWriter::Channel transforms_, fixed_transforms_, true_pose_, estimated_pose_,
      scene_, truth_, estimate_, control_, imu_, detections_, image_ = 0, annotations_ = 0;
  std::string text_;  ///< Text of the message in work.
  std::size_t ticks_ = 0, looks_ = 0;
  double next_state_ = 0.0;  ///< [s]
};

}  // namespace gatefly::simulated_race
