// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/track_keys.hpp"

#include <algorithm>
#include <iomanip>
#include <set>
#include <sstream>
#include <stdexcept>

#include "gatefly/config/config.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/config/shown_keys.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::config {
namespace {

constexpr double kFarthest = 1000.0;  // [m] from the origin

std::string line(const std::string& name, const std::string& value, const std::string& what,
                 bool left_out) {
  std::ostringstream text;
  text << std::left << std::setw(38) << (left_out ? "# " : "") + name + " = " + value << "  # "
       << what << '\n';
  return text.str();
}

/// Picks the wanted keys of configs/default.toml.
template <class Wanted>
std::string file_with(const Wanted& wanted) {
  std::vector<ShownKey> keys = shown_keys(load_config(config_files({})));
  std::erase_if(keys, [&](const ShownKey& key) { return !wanted(key.name); });
  return as_file(keys);
}

std::string section_lines(std::string_view section) {
  std::string text;
  const bool left_out = section == "exit";
  for (const TrackKey& key : track_keys())
    if (key.section == section)
      text +=
          line(key.name, key.example,
               key.what + (*key.otherwise == '\0' ? std::string{}
                                                  : "; without it " + std::string{key.otherwise}),
               key.left_out || left_out);
  return text;
}

std::string randomize_lines() {
  const world::Randomize race = randomized({}, {{"level", "race"}}, "");
  std::string text = line("level", "\"race\"", "none, race or hard", false);
  for (const auto& key : randomize_keys())
    text += line(key.rule.name.substr(key.rule.name.find('.') + 1), files::shown(key.get(race)),
                 key.rule.what, true);
  return text;
}

std::string fault_lines() {
  std::string text;
  for (const auto& key : fault_keys())
    text += line(key.rule.name.substr(key.rule.name.find('.') + 1), files::shown(key.get({})),
                 key.rule.what, true);
  return text;
}

}  // namespace

const std::vector<TrackKey>& track_keys() {
  static const std::vector<TrackKey> keys{
      {"", "name", "\"my course\"", "as it is called in results", "the file's name"},
      {"", "laps", "2", "how often round, 1..100", "1", 1, 100},
      {"start", "position_m", "[0.0, 0.0]", "north, east; on the floor", "", -kFarthest, kFarthest},
      {"start", "heading_deg", "0.0", "clockwise from north", "0", -720, 720},
      {"gates", "position_m", "[4.0, 0.0, -1.5]", "centre of the opening: north, east, down", "",
       -kFarthest, kFarthest},
      {"gates", "heading_deg", "0.0", "direction of flight through it, clockwise from north", "0",
       -720, 720},
      {"gates", "side_m", "1.0", "outer side", "gate.side_m of the configuration", 0.3, 5},
      {"gates", "bar_m", "0.05", "width of its bars", "gate.bar_m of the configuration", 0.005, 1},
      {"gates", "depth_m", "0.05", "depth of its bars, along the way through it",
       "as bar_m, 0.10 at most", 0.005, 1},
      {"gates", "color", "\"orange\"", "a name or [r, g, b], 0..1",
       "color.rgb of the configuration", 0, 1, track_colors()},
      {"gates",
       "position_sigma_m",
       "[0.12, 0.12, 0.05]",
       "how well position_m is known, one sigma: north, east, down",
       "gate.map_sigma_m, gate.height_sigma_m",
       0.001,
       5,
       {},
       true},
      {"gates",
       "heading_sigma_deg",
       "3.4",
       "how well heading_deg is known, one sigma",
       "gate.heading_sigma_deg",
       0.01,
       90,
       {},
       true},
      {"gates",
       "side_sigma_m",
       "0.012",
       "how well side_m is known, one sigma",
       "1.2 % of side_m",
       0.0001,
       1,
       {},
       true},
      {"exit", "run_m", "0.5", "straight on behind the gate", "", 0, 100},
      {"exit", "turn", "\"right\"", "left or right", "left", 0, 0, {"left", "right"}},
      {"exit", "angle_deg", "180.0", "by how much it turns", "", 0, 360},
      {"exit", "radius_m", "1.5", "of the turn", "", 0.3, 100},
      {"obstacles", "box_m", "[0.4, 0.4, 2.0]", "along its own axes, height", "pole_m", 0.01, 100},
      {"obstacles",
       "pole_m",
       "[0.1, 2.0]",
       "in place of box_m: radius, height",
       "box_m",
       0.005,
       100,
       {},
       true},
      {"obstacles", "position_m", "[2.0, 1.5]", "its middle on the floor: north, east", "",
       -kFarthest, kFarthest},
      {"obstacles", "heading_deg", "0.0", "of its first axis, clockwise from north", "0", -720,
       720},
      {"room", "size_m", "[14.0, 12.0, 3.5]", "north, east, height", "[14, 16, 3.2]", 1, kFarthest},
      {"room", "center_m", "[2.0, 1.5]", "north, east", "[0, 0]", -kFarthest, kFarthest},
      {"room",
       "look",
       "\"hall\"",
       "textures and lights: hall, showroom, dark_hall or exhibition",
       "hall",
       0,
       0,
       {"hall", "showroom", "dark_hall", "exhibition"}},
  };
  return keys;
}

const TrackKey& track_key(std::string_view section, std::string_view name) {
  for (const TrackKey& key : track_keys())
    if (key.section == section && key.name == name) return key;
  throw std::logic_error("track_keys() has no " + std::string{section} + "." + std::string{name});
}

std::string new_track() {
  return "# A course for gatefly. Metres and degrees; x north, y east, z down, heading clockwise "
         "from\n"
         "# north; z = 0 is the floor. What has a # before it may be left out.\n"
         "# gatefly track FILE checks it, gatefly fly FILE flies it.\n" +
         section_lines("") + "\n[start]\n" + section_lines("start") +
         "\n# Gates, in the order of flight.\n[[gates]]\n" + section_lines("gates") +
         "# How to leave this gate, for control.mode = \"paper\" only; else gatefly plans the "
         "way.\n"
         "# [gates.exit]\n" +
         section_lines("exit") +
         "\n[[gates]]\nposition_m = [0.0, 3.0, -1.5]\nheading_deg = 180.0\n"
         "\n# Boxes and poles that stand on the floor: one [[obstacles]] each.\n[[obstacles]]\n" +
         section_lines("obstacles") + "\n# Walls, ceiling, light.\n[room]\n" +
         section_lines("room") +
         "\n# What the simulator changes with every seed: one standard deviation each, of the "
         "level "
         "if not said.\n[randomize]\n" +
         randomize_lines() +
         "\n# What breaks, for a test: nothing if not said. Gates and rotors count from 1.\n"
         "[faults]\n" +
         fault_lines();
}

std::string new_config(const std::string& section) {
  return file_with(
      [&](const std::string& key) { return section.empty() || key.starts_with(section + "."); });
}

std::string new_vehicle() {
  static const std::set<std::string> of_a_vehicle{"sim.size_m",
                                                  "sim.propeller_radius_m",
                                                  "sim.rotor_time_constant_ms",
                                                  "sim.rotor_drag_per_s",
                                                  "sim.body_drag_per_m",
                                                  "sim.inertia_ratio",
                                                  "sim.air_moment_nms_per_m",
                                                  "sim.battery_capacity_ah",
                                                  "sim.battery_full_v",
                                                  "sim.battery_empty_v",
                                                  "sim.battery_resistance_ohm",
                                                  "sim.hover_power_w",
                                                  "sim.electronics_power_w",
                                                  "sim.sag_time_s",
                                                  "filter.drag_per_s"};
  return file_with([](const std::string& key) {
    return key.starts_with("vehicle.") || of_a_vehicle.contains(key);
  });
}

}  // namespace gatefly::config
