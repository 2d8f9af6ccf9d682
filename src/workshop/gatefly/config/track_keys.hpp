// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gatefly::config {

/// A key of a track file: what the reader allows and what a new file says of it.
struct TrackKey {
  std::string_view section;  ///< "" for the top, "start", "gates", "exit", "obstacles", "room".
  const char* name;
  const char* example;  ///< As it stands in a new file.
  const char* what;
  const char* otherwise;                  ///< Value when left out; "" if it may not be.
  double low = 0.0, high = 0.0;           ///< Bounds of every number.
  std::vector<std::string> choices = {};  ///< Words of a text that is one of a few.
  bool left_out = false;                  ///< A comment in a new file: it excludes another.
};

inline constexpr std::size_t kMaxGates = 200, kMaxObstacles = 1000;

/// The one table of all keys of a track file but [randomize]'s, in the order of a new file.
[[nodiscard]] const std::vector<TrackKey>& track_keys();

/// @throws std::logic_error when the table has no such key: the reader asks for no other.
[[nodiscard]] const TrackKey& track_key(std::string_view section, std::string_view name);

/// A track file with two gates that can be flown, every key explained.
[[nodiscard]] std::string new_track();

/// configs/default.toml's values with every key explained; of one [section] when it is not "".
[[nodiscard]] std::string new_config(const std::string& section = "");

/// The same of a vehicle: [vehicle], what the simulator takes for true of it, the pilot's idea of
/// its drag.
[[nodiscard]] std::string new_vehicle();

}  // namespace gatefly::config
