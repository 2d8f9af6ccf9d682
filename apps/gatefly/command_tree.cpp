// SPDX-License-Identifier: Apache-2.0
#include "command_tree.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Output of another program; "" when it fails.
std::string said_by(const char* program, const std::string& arguments) {
  std::string path;
  for (const char c : sibling(program).string()) path += c == '\'' ? "'\\''" : std::string{c};
  FILE* const pipe = popen(("'" + path + "' " + arguments + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return "";
  std::string said;
  std::array<char, 4096> piece{};
  while (const std::size_t size = fread(piece.data(), 1, piece.size(), pipe))
    said.append(piece.data(), size);
  return pclose(pipe) == 0 ? said : std::string{};
}

CommandInfo command_of(const ordered_json& json) {
  CommandInfo command{json["name"], json["help"], json["footer"], {}};
  for (const ordered_json& flag : json["flags"])
    command.flags.push_back({.names = flag["names"],
                             .value = flag["value"],
                             .help = flag["help"],
                             .choices = flag["choices"],
                             .required = flag["required"],
                             .repeated = flag["repeated"]});
  return command;
}

/// The names of the files in a folder that gatefly comes with.
std::vector<std::string> shipped(const char* folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(files::shipped_dir() / folder, error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

ordered_json as_json(const std::vector<CommandInfo>& commands) {
  ordered_json list = ordered_json::array();
  for (const CommandInfo& command : commands) {
    ordered_json flags = ordered_json::array();
    for (const FlagInfo& flag : command.flags)
      flags.push_back({{"names", flag.names},
                       {"value", flag.value},
                       {"help", flag.help},
                       {"choices", flag.choices},
                       {"required", flag.required},
                       {"repeated", flag.repeated}});
    list.push_back({{"name", command.name},
                    {"help", command.help},
                    {"footer", command.footer},
                    {"flags", flags}});
  }
  return list;
}

std::vector<CommandInfo> whole_tree(std::vector<CommandInfo> here) {
  const auto is_elsewhere = [](const CommandInfo& command) {
    const auto mine = commands_here();
    return std::none_of(mine.begin(), mine.end(),
                        [&](const CommandHere& each) { return each.name == command.name; });
  };
  if (std::none_of(here.begin(), here.end(), is_elsewhere)) return here;
  const auto self = fs::read_symlink("/proc/self/exe");
  for (const char* const program : {kProgram, kTools, kLaboratory, kStudies}) {
    if (sibling(program) == self) continue;
    const std::string said = said_by(program, kPrintCommands);
    if (said.empty())
      throw std::runtime_error(sibling(program).string() +
                               ": is not there, or of another version; build it, or start gatefly "
                               "by ./gatefly");
    for (const ordered_json& json : ordered_json::parse(said)) {
      const CommandInfo told = command_of(json);
      for (CommandInfo& command : here)
        if (command.name == told.name && is_elsewhere(command)) command = told;
    }
  }
  return here;
}

Words words_for_shells() {
  Words words{
      shipped("tracks"), shipped("configs"), shipped("cameras"), shipped("vehicles"), {}, {}};
  // A name that is a camera's and a vehicle's is not taken: files::find_config.
  std::set_symmetric_difference(words.cameras.begin(), words.cameras.end(), words.vehicles.begin(),
                                words.vehicles.end(), std::back_inserter(words.configs));
  for (const auto& key : config::config_keys()) words.keys.push_back(key.rule.name);
  words.keys.push_back(config::randomize_level_rule().name);
  for (const auto& key : config::randomize_keys()) words.keys.push_back(key.rule.name);
  for (const auto& key : config::fault_keys()) words.keys.push_back(key.rule.name);
  const auto listed =
      ordered_json::parse(said_by(kStudies, "reproduce --list --json"), nullptr, false);
  if (listed.is_array())
    for (const ordered_json& experiment : listed) words.experiments.push_back(experiment["name"]);
  return words;
}

}  // namespace gatefly::cli
