// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "gatefly/flight_log/foreign_logs/foreign_flight.hpp"

namespace gatefly::foreign_logs {

/// Pictures as the folder has them, and those that are none.
struct CopiedPictures {
  std::size_t copied = 0;
  std::vector<std::string> unreadable;  ///< A line for each.
};

/// Refuses what must not be replaced, before the work. @throws std::runtime_error one line.
void check_import_folder(const std::filesystem::path& out);

/// Writes a flight folder that `replay` reads, whole or not at all.
/// @param files  others in it, by name: track, configuration.
/// @param summary  content of summary.json, given how the pictures fared.
/// @param on_picture  called before each.
CopiedPictures write_imported(const ForeignFlight& flight, const std::filesystem::path& out,
                              const std::map<std::string, std::string>& files,
                              const std::function<std::string(const CopiedPictures&)>& summary,
                              const std::function<void()>& on_picture);

}  // namespace gatefly::foreign_logs
