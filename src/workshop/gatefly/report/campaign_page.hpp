// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace gatefly::report {

/// Page on a folder of `gatefly campaign`, for a browser: how often, how fast, what
/// went wrong, and the command that flies each run again. A run that was flown into the folder
/// (TRACK-SEED/ in it) is linked.
/// @throws std::runtime_error one line: no campaign, damaged.
[[nodiscard]] std::string campaign_page(const std::filesystem::path& folder);

/// The flights in a folder, each with its summary; those in `folder` itself, not deeper.
[[nodiscard]] std::string folder_page(const std::filesystem::path& folder);

/// Kind of page that a path leads to.
enum class Viewable { kFlight, kCampaign, kFolder };

/// @throws std::runtime_error one line: nothing that gatefly has written.
[[nodiscard]] Viewable viewable(const std::filesystem::path& path);

}  // namespace gatefly::report
