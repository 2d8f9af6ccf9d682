// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gatefly/race/track.hpp"
#include "gatefly/tasks/smoothing/learnt_map.hpp"

namespace gatefly::smoothing {

/// How a learnt track file begins.
inline constexpr const char* kLearntTrack = "# Learnt by gatefly map";

/// A track whose gates are those of a learnt map, with their sigmas.
/// @param intake  of a flight on it: says which of its gates is which landmark.
[[nodiscard]] Track with_map(Track track, const LearntMap& map, const Intake& intake);

/// The track file `path` with the gates' places and sigmas of `learnt`; its comments are left out.
/// @param from  the flights, for its first lines.
[[nodiscard]] std::string track_file_with(const std::filesystem::path& path, const Track& learnt,
                                          const std::vector<std::string>& from);

}  // namespace gatefly::smoothing
