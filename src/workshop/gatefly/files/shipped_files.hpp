// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

// Files that gatefly comes with (tracks, configurations, cameras, vehicles, the report's page), and
// the folders it uses.
namespace gatefly::files {

/// The folder share/gatefly with tracks/, configs/, cameras/ and vehicles/; empty when there is none.
///
/// Looked for above the program (or above Python's module), so that an installation works wherever
/// it was put and the build folder has one of its own; then in $XDG_DATA_DIRS.
[[nodiscard]] std::filesystem::path shipped_dir();

/// Folder of things computed once: gatefly/ in $XDG_CACHE_HOME, else in ~/.cache.
[[nodiscard]] std::filesystem::path cache_dir();

/// Folder of real data: $GATEFLY_DATA, else the sibling folder ../shared/data.
[[nodiscard]] std::filesystem::path data_folder();

/// A file by its path, here or in what gatefly comes with ("cameras/bebop.toml"), or by its name in
/// `folder`: ./folder first, then what gatefly comes with.
/// @throws std::runtime_error listing the names there are.
[[nodiscard]] std::filesystem::path find_toml(const std::string& name, const std::string& folder);

/// A configuration by its path, or by its name in configs/, else in cameras/ or vehicles/.
/// @throws std::runtime_error listing the names there are; or naming both when two are meant.
[[nodiscard]] std::filesystem::path find_config(const std::string& name);

/// The names that find_toml() finds in a folder, sorted.
[[nodiscard]] std::vector<std::string> toml_names(const std::string& folder);

}  // namespace gatefly::files
