// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "command_line.hpp"

// The command lines of all programs as one tree, for shells and for the manual page.
namespace gatefly::cli {

/// Request from one of our programs to another.
inline constexpr const char* kPrintCommands = "--print-commands";

[[nodiscard]] nlohmann::ordered_json as_json(const std::vector<CommandInfo>& commands);

/// Words that a shell may suggest besides commands and flags.
struct Words {
  std::vector<std::string> tracks, configs, cameras, vehicles, keys, experiments;
};

/// All commands; the other programs are asked for the flags of theirs.
/// @throws std::runtime_error when one of them is not there.
[[nodiscard]] std::vector<CommandInfo> whole_tree(std::vector<CommandInfo> here);
[[nodiscard]] Words words_for_shells();

[[nodiscard]] std::string bash_completion(const std::vector<CommandInfo>& tree, const Words& words);
[[nodiscard]] std::string zsh_completion(const std::vector<CommandInfo>& tree, const Words& words);
[[nodiscard]] std::string fish_completion(const std::vector<CommandInfo>& tree, const Words& words);

/// gatefly.1, in mdoc.
[[nodiscard]] std::string manual_page(const std::vector<CommandInfo>& tree);

}  // namespace gatefly::cli
