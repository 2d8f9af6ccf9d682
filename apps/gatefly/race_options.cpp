// SPDX-License-Identifier: Apache-2.0
#include "race_options.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace gatefly::cli {

std::string shell_quoted(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view{"._-/=+,:"}.find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return result + "'";
}

void add_race_options(Command& command, RaceOptions& options) {
  command.option("--laps", options.laps, "instead of the track's own number").between(1, 100);
  command
      .option("--vision", options.vision,
              "rendered: pictures, really detected; ideal: detections drawn from the "
              "detector's statistics, fast")
      .one_of({"rendered", "ideal"})
      .show_default();
  add_drone(command, options.drone);
  add_speed(command, options.drone);
  add_common(command, options.common);
}

simulated_race::RaceMaker race_maker(const RaceOptions& options) {
  simulated_race::RaceMaker maker({.config = options.common,
                                   .track = options.track,
                                   .vision = options.vision,
                                   .laps = options.laps});
  say_notes(maker.notes());
  return maker;
}

std::string fly_command(const RaceOptions& options, const std::string& seed) {
  return "gatefly fly " + shell_quoted(options.track) + " --seed " + seed + race_flags(options);
}

std::string race_flags(const RaceOptions& options) {
  std::string command;
  if (options.laps) command += " --laps " + std::to_string(*options.laps);
  if (options.vision != "rendered") command += " --vision " + options.vision;
  for (const auto& config : options.common.configs) command += " --config " + shell_quoted(config);
  for (const auto& setting : options.common.settings) command += " --set " + shell_quoted(setting);
  return command;
}

}  // namespace gatefly::cli
