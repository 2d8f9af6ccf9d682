// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/drawing/video_file.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"
#include "gatefly/simulated_race/results/flight_map.hpp"

namespace gatefly::simulated_race {

/// A flight as a film, drawn while it is flown, in real time: what the pilot saw, where it flew,
/// how high and how fast, and at the end how well. Draws only; the flight is the same without it.
class FlightVideo {
 public:
  /// @param mp4       written as VideoFile says: whole or not at all.
  /// @param title     e.g. "showroom, seed 1"
  /// @param pictures  false when the race has none (ideal vision): the map takes their place.
  /// @throws std::runtime_error when ffmpeg cannot be started.
  FlightVideo(const std::filesystem::path& mp4, const RaceConfig& race, std::string title,
              bool pictures);

  /// Every tick of the race, in order. @throws std::runtime_error when ffmpeg has given up.
  void record(const flight_log::Tick& tick);
  /// Every tick after a crash: the drone falls, the moment and place of contact stay marked.
  void record_fall(const flight_log::Tick& tick, const RaceResult& result);
  /// Holds the last frame, where the race was lost by a contact with that marked in it, then with a
  /// card over it: laps, times, speed, error, what went wrong. Then completes the file.
  /// @param verdict  in words: "crashed into a pole at ..."
  void finish(const RaceResult& result, const std::string& verdict);

 private:
  void start(const flight_log::Tick& tick);
  void look(const flight_log::Tick& tick);
  void add_frames(const flight_log::Tick& tick);
  void draw(const flight_log::Tick& tick);
  void draw_contact();
  void touch(const RaceResult& result);
  void draw_head(const flight_log::Tick& tick);
  void draw_status(const flight_log::Tick& tick, const drawing::Box& box);
  void draw_strips(const flight_log::Tick& tick, const drawing::Box& box);
  void draw_view(const flight_log::Tick& tick);
  void draw_map(const flight_log::Tick& tick);

  RaceConfig race_;
  std::string title_;
  bool pictures_;
  drawing::Box left_, map_box_;
  FlightMap map_;
  drawing::VideoFile file_;
  /// The fixed background; the frame being drawn; the last picture with detections.
  drawing::Canvas backdrop_, frame_, view_;
  std::vector<Moment> moments_;                  ///< One a frame.
  Moment last_;                                  ///< The latest tick, between two frames.
  std::vector<double> passes_;                   ///< When the pilot counted a gate [s].
  std::optional<Eigen::Vector2d> picture_size_;  ///< Upright [px]; nullopt before the first one.
  Sighting::Source source_ = Sighting::Source::kNone;
  struct Contact {
    Moment moment;
    std::string text;        ///< "21.5 s, contact: right bar of gate 3".
    std::size_t frames = 0;  ///< So many are drawn since.
  };
  std::optional<Contact> contact_;
};

}  // namespace gatefly::simulated_race
