// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gatefly::files {

/// The files that a path on the command line means, sorted by name: itself, or a folder's .jpg,
/// .jpeg, .png, .ppm (not what lies in folders below; raw .uyvy only when named).
///
/// @throws std::runtime_error one line: there is no such path, or the folder has no picture.
[[nodiscard]] std::vector<std::filesystem::path> picture_files(const std::filesystem::path& path);

/// "folder: left out: a.bmp, b.webp (a folder means ...)": pictures of kinds that a folder does not
/// mean; "" when there are none, or the path is no folder.
[[nodiscard]] std::string left_out_of(const std::filesystem::path& path);

/// A path as it is given, when it is there; else below the folder of real data, "../shared/data/X" as
/// X; else in what gatefly comes with ("tests/replay/oval_flight").
///
/// Real data: `data` if not empty, else $GATEFLY_DATA, else the sibling folder ../shared/data.
/// @throws std::runtime_error `data` is given, but no folder.
[[nodiscard]] std::filesystem::path find_data(const std::filesystem::path& path,
                                              const std::string& data);

/// X of "../shared/data/X", which is what pages call the folder of real data; other paths as they are.
[[nodiscard]] std::filesystem::path below_shared_data(const std::filesystem::path& path);

}  // namespace gatefly::files
