// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "gatefly/config/config.hpp"
#include "gatefly/config/track_file.hpp"

// Configuration and track of whom who has no files: an autopilot's own parameters, the C interface.
namespace gatefly::config {

/// Content of a file, and its name in messages.
struct TextFile {
  std::string name, content;
};

/// load_config() with a text after the files; files named in it are looked for where it says.
[[nodiscard]] Config load_config(std::span<const std::filesystem::path> files,
                                 std::span<const std::string> settings,
                                 const std::optional<TextFile>& text);

/// read_track() of a text; its name is also that of a track that does not say its own.
[[nodiscard]] TrackFile read_track(const TextFile& text, const GateDescription& gates = {});

}  // namespace gatefly::config
