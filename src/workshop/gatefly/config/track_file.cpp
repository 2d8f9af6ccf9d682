// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/track_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/config/texts.hpp"
#include "gatefly/config/track_keys.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::config {
namespace {

using nlohmann::json;

constexpr double kSunk = 1e-6;  // [m] a gate that stands on the floor may be so low by rounding

/// Linear-light albedos of painted wood and cloth. [estimate]
const std::vector<std::pair<std::string, Eigen::Vector3d>>& colors() {
  static const std::vector<std::pair<std::string, Eigen::Vector3d>> list{
      {"orange", {0.95, 0.40, 0.12}}, {"red", {0.75, 0.07, 0.07}},
      {"blue", {0.07, 0.15, 0.75}},   {"green", {0.10, 0.60, 0.12}},
      {"yellow", {0.90, 0.75, 0.08}}, {"magenta", {0.80, 0.08, 0.55}},
      {"white", {0.85, 0.85, 0.85}},  {"black", {0.04, 0.04, 0.04}}};
  return list;
}

/// "gate 1": people count from 1, in files and plans alike.
std::string counted(const char* what, std::size_t index) {
  return std::string{what} + " " + std::to_string(index + 1);
}

/// One [section] of the file: its keys and their bounds are those of track_keys().
class Section {
 public:
  Section(files::Table table, const char* name) : table_{std::move(table)}, name_{name} {}

  [[nodiscard]] files::Table& table() { return table_; }
  [[nodiscard]] bool has(const char* key) { return table_.has(rule(key).name); }
  double number(const char* key) { return table_.number(key, rule(key).low, rule(key).high); }
  double number(const char* key, double fallback) {
    return table_.number(key, rule(key).low, rule(key).high, fallback);
  }
  int integer(const char* key, int fallback) {
    return table_.integer(key, static_cast<int>(rule(key).low), static_cast<int>(rule(key).high),
                          fallback);
  }
  std::vector<double> numbers(const char* key, std::size_t count) {
    return table_.numbers(key, count, rule(key).low, rule(key).high);
  }
  std::string text(const char* key, const std::string& fallback) {
    return table_.text(rule(key).name, fallback);
  }
  const json& raw(const char* key) { return table_.raw(rule(key).name); }
  Eigen::Vector2d floor_point(const char* key) {
    const auto p = numbers(key, 2);
    return {p[0], p[1]};
  }
  double heading() { return wrap_angle(number("heading_deg", 0.0) * kDegree); }
  [[noreturn]] void fail(const char* key, const std::string& what) const { table_.fail(key, what); }
  void refuse_others() const { table_.refuse_others(); }

 private:
  [[nodiscard]] const TrackKey& rule(const char* key) const { return track_key(name_, key); }

  files::Table table_;
  const char* name_;
};

/// The albedo that a camera shows as this sRGB colour; of the generic orange the painted one.
Eigen::Vector3d albedo_of(const Eigen::Vector3d& rgb) {
  if (rgb == GateDescription{}.rgb) return colors().front().second;
  return rgb.unaryExpr(
      [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); });
}

Eigen::Vector3d read_color(Section& gate, const GateDescription& defaults) {
  const json& value = gate.raw("color");
  if (value.is_null()) return albedo_of(defaults.rgb);
  if (value.is_array()) {
    const auto rgb = gate.table().numbers("color", 3, 0, 1);
    return {rgb[0], rgb[1], rgb[2]};
  }
  for (const auto& [name, color] : colors())
    if (value.is_string() && value.get<std::string>() == name) return color;
  gate.fail("color", "[r, g, b] in 0..1 or one of " + files::joined(track_colors()));
}

std::optional<GateExit> read_exit(files::Table& gate) {
  if (!gate.has("exit")) return std::nullopt;
  Section table{gate.table("exit"), "exit"};
  GateExit exit{.run = table.number("run_m")};
  const std::string turn = table.text("turn", "left");
  if (turn != "left" && turn != "right") table.fail("turn", "\"left\" or \"right\"");
  exit.angle = table.number("angle_deg") * kDegree * (turn == "left" ? -1.0 : 1.0);
  exit.radius = table.number("radius_m");
  table.refuse_others();
  return exit;
}

/// How well a gate is known, where its file says so.
struct GateSigmas {
  std::optional<Eigen::Vector3d> position;
  std::optional<double> yaw, side;
};

GateSigmas read_sigmas(Section& gate) {
  GateSigmas sigmas;
  if (gate.has("position_sigma_m")) {
    const auto p = gate.numbers("position_sigma_m", 3);
    sigmas.position = Eigen::Vector3d{p[0], p[1], p[2]};
  }
  if (gate.has("heading_sigma_deg")) sigmas.yaw = gate.number("heading_sigma_deg") * kDegree;
  if (gate.has("side_sigma_m")) sigmas.side = gate.number("side_sigma_m");
  return sigmas;
}

void read_gate(Section table, const GateDescription& defaults, TrackFile& track) {
  const auto p = table.numbers("position_m", 3);
  const double yaw = table.heading();
  const double side = table.number("side_m", defaults.side);
  const double bar = table.number("bar_m", defaults.bar);
  const double depth = table.number("depth_m", usual_depth(bar));
  const Eigen::Vector3d color = read_color(table, defaults);
  const auto exit = read_exit(table.table());
  const GateSigmas sigmas = read_sigmas(table);
  table.refuse_others();

  if (2 * bar >= side) table.fail("bar_m", "less than half of side_m = " + files::text_of(side));
  const double lowest = -p[2] - 0.5 * side, highest = -p[2] + 0.5 * side;
  if (lowest < -kSunk)
    table.fail("position_m", "so high that the lower bar is not below the floor: z at most " +
                                 files::text_of(-0.5 * side, 6));
  if (highest > track.track.ceiling)
    table.fail("position_m", "below the ceiling at " + files::text_of(track.track.ceiling) +
                                 " m with its upper bar");

  const Eigen::Vector3d center{p[0], p[1], p[2]};
  track.track.gates.push_back({.p_EG = center,
                               .yaw_EG = yaw,
                               .side = side,
                               .bar = bar,
                               .depth = depth,
                               .exit = exit,
                               .position_sigma = sigmas.position,
                               .yaw_sigma = sigmas.yaw,
                               .side_sigma = sigmas.side});
  track.world.gates.push_back(
      {.p_EG = center, .yaw_EG = yaw, .side = side, .bar = bar, .color = color, .depth = depth});
}

void read_obstacle(Section table, TrackFile& track) {
  world::WorldBox box;
  box.center = table.floor_point("position_m");
  box.heading = table.heading();
  box.pole = table.has("pole_m");
  if (box.pole && table.has("box_m")) table.fail("pole_m", "left out where box_m is given");
  if (box.pole) {
    const auto pole = table.numbers("pole_m", 2);
    box.size = {2 * pole[0], 2 * pole[0]};
    box.top = pole[1];
  } else {
    const auto size = table.numbers("box_m", 3);
    box.size = {size[0], size[1]};
    box.top = size[2];
  }
  table.refuse_others();
  track.world.obstacles.push_back(box);
  track.track.obstacles.push_back(
      {.center = box.center, .size = box.size, .heading = box.heading, .height = box.top});
}

void read_room(files::Table& file_table, TrackFile& track) {
  world::World& world = track.world;
  if (file_table.has("room")) {
    Section room{file_table.table("room"), "room"};
    if (room.has("size_m")) {
      const auto size = room.numbers("size_m", 3);
      world.room_size = {size[0], size[1], size[2]};
    }
    if (room.has("center_m")) world.room_center = room.floor_point("center_m");
    world.look = room.text("look", world.look);
    const auto& looks = track_key("room", "look").choices;
    if (std::find(looks.begin(), looks.end(), world.look) == looks.end())
      room.fail("look", "one of " + files::joined(looks));
    room.refuse_others();
  }
  track.track.room_center = world.room_center;
  track.track.room_size = world.room_size.head<2>();
  track.track.ceiling = world.room_size.z();
}

void read_start(files::Table& file_table, TrackFile& track) {
  if (!file_table.has("start")) return;
  Section start{file_table.table("start"), "start"};
  track.start.position = start.floor_point("position_m");
  track.start.heading = start.heading();
  start.refuse_others();
  track.track.start = track.start.position;
  track.track.start_heading = track.start.heading;
}

bool in_room(const Track& track, const Eigen::Vector2d& p) {
  return ((p - track.room_center).cwiseAbs().array() <= 0.5 * track.room_size.array()).all();
}

/// A box with its heading, by its four corners; a pole by its square.
bool in_room(const Track& track, const MapObstacle& box) {
  const double c = cos(box.heading), s = sin(box.heading);
  for (const double a : {-0.5, 0.5})
    for (const double b : {-0.5, 0.5}) {
      const Eigen::Vector2d corner{a * box.size.x(), b * box.size.y()};
      const Eigen::Vector2d turned{c * corner.x() - s * corner.y(),
                                   s * corner.x() + c * corner.y()};
      if (!in_room(track, box.center + turned)) return false;
    }
  return true;
}

void check_inside_room(const Track& track, const files::TomlFile& file) {
  const auto fail = [&](const std::string& pointer, const std::string& name,
                        const Eigen::Vector2d& p) {
    throw std::runtime_error(file.place(pointer + "/position_m") + ": " + name + "position_m = [" +
                             files::text_of(p.x(), 6) + ", " + files::text_of(p.y(), 6) +
                             "], must be inside the room, all of it (room.size_m, room.center_m)");
  };
  if (!in_room(track, track.start)) fail("/start", "start.", track.start);
  for (std::size_t i = 0; i < track.gates.size(); ++i)
    if (!in_room(track, track.gates[i].p_EG.head<2>()))
      fail("/gates/" + std::to_string(i), counted("gate", i) + ": ", track.gates[i].p_EG.head<2>());
  for (std::size_t i = 0; i < track.obstacles.size(); ++i)
    if (!in_room(track, track.obstacles[i]))
      fail("/obstacles/" + std::to_string(i), counted("obstacle", i) + ": ",
           track.obstacles[i].center);
}

const json& list_of(files::Table& table, const char* key, std::size_t least, std::size_t most) {
  static const json none = json::array();
  const json& list = table.raw(key);
  if (list.is_null() && least == 0) return none;
  if (!list.is_array() || list.size() < least || list.size() > most)
    table.fail(key,
               std::to_string(least) + ".." + std::to_string(most) + " tables [[" + key + "]]");
  return list;
}

TrackFile track_of(const files::TomlFile& file, const std::filesystem::path& path,
                   const GateDescription& defaults) {
  Section top{files::Table(file), ""};
  files::Table& table = top.table();

  TrackFile track;
  constexpr std::size_t kLongestName = 200;
  track.track.name = files::one_line(top.text("name", path.stem().string()), kLongestName);
  track.track.laps = top.integer("laps", 1);
  read_room(table, track);
  read_start(table, track);
  const std::size_t gates = list_of(table, "gates", 1, kMaxGates).size();
  for (std::size_t i = 0; i < gates; ++i)
    read_gate({table.item("gates", i, counted("gate", i)), "gates"}, defaults, track);
  const std::size_t obstacles = list_of(table, "obstacles", 0, kMaxObstacles).size();
  for (std::size_t i = 0; i < obstacles; ++i)
    read_obstacle({table.item("obstacles", i, counted("obstacle", i)), "obstacles"}, track);

  json randomize = table.raw("randomize");
  if (randomize.is_null()) randomize = json::object();
  if (!randomize.is_object()) table.fail("randomize", "a table");
  for (const auto& [key, value] : randomize.items())
    check_randomize(key, value, file.place("/randomize/" + key));
  if (!randomize.contains("level")) randomize["level"] = "race";
  track.randomize = randomized({}, randomize, path.string());

  json faults = table.raw("faults");
  if (faults.is_null()) faults = json::object();
  if (!faults.is_object()) table.fail("faults", "a table");
  for (const auto& [key, value] : faults.items())
    check_fault(key, value, file.place("/faults/" + key));
  track.faults = with_faults({}, faults, path.string());
  table.refuse_others();
  check_inside_room(track.track, file);
  return track;
}

}  // namespace

TrackFile read_track(const std::filesystem::path& path, const GateDescription& defaults) {
  return track_of(files::TomlFile{path}, path, defaults);
}

TrackFile read_track(const TextFile& text, const GateDescription& defaults) {
  return track_of(files::TomlFile{text.name, text.content}, text.name, defaults);
}

std::vector<std::string> track_colors() {
  std::vector<std::string> names;
  for (const auto& [name, color] : colors()) names.push_back(name);
  return names;
}

std::filesystem::path find_track(const std::string& name) {
  return files::find_toml(name, "tracks");
}

}  // namespace gatefly::config
