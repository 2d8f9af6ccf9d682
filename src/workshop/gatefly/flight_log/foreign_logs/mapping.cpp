// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/mapping.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::foreign_logs {
namespace {

using files::Table;
using files::TomlFile;
using nlohmann::json;

struct Unit {
  const char* name;
  const char* ours;  ///< Name in our log.
  double factor;
};
constexpr std::array kUnits{
    Unit{"rad/s", "rad/s", 1.0}, Unit{"deg/s", "rad/s", kDegree}, Unit{"rpm", "rad/s", kPi / 30.0},
    Unit{"m/s^2", "m/s^2", 1.0}, Unit{"g", "m/s^2", kGravity},    Unit{"m", "m", 1.0},
    Unit{"cm", "m", 0.01},       Unit{"mm", "m", 0.001},          Unit{"m/s", "m/s", 1.0},
    Unit{"cm/s", "m/s", 0.01},   Unit{"rad", "rad", 1.0},         Unit{"deg", "rad", kDegree},
    Unit{"V", "V", 1.0},         Unit{"mV", "V", 0.001},          Unit{"1", "1", 1.0}};
constexpr std::array kTimeUnits{"s", "ms", "us", "ns"};

struct Known {
  const char* column;
  const char* unit;
};
constexpr std::array kKnown{Known{"gyro_p_radps", "rad/s"},
                            Known{"gyro_q_radps", "rad/s"},
                            Known{"gyro_r_radps", "rad/s"},
                            Known{"acc_x_mps2", "m/s^2"},
                            Known{"acc_y_mps2", "m/s^2"},
                            Known{"acc_z_mps2", "m/s^2"},
                            Known{"sonar_m", "m"},
                            Known{"baro_m", "m"},
                            Known{"ot_x_m", "m"},
                            Known{"ot_y_m", "m"},
                            Known{"ot_z_m", "m"},
                            Known{"ot_vx_mps", "m/s"},
                            Known{"ot_vy_mps", "m/s"},
                            Known{"ot_vz_mps", "m/s"},
                            Known{"true_roll_rad", "rad"},
                            Known{"true_pitch_rad", "rad"},
                            Known{"true_yaw_rad", "rad"},
                            Known{"ahrs_phi_rad", "rad"},
                            Known{"ahrs_theta_rad", "rad"},
                            Known{"ahrs_psi_rad", "rad"},
                            Known{"thrust_cmd", "1"},
                            Known{"motor_lf_radps", "rad/s"},
                            Known{"motor_rf_radps", "rad/s"},
                            Known{"motor_rb_radps", "rad/s"},
                            Known{"motor_lb_radps", "rad/s"},
                            Known{"battery_v", "V"}};

template <class List>
std::string names_in(const List& list) {
  std::vector<std::string> names;
  for (const auto& one : list) names.emplace_back(one);
  return "one of " + files::joined(names);
}

/// Units that can be turned into `ours`.
std::string units_for(std::string_view ours) {
  std::vector<std::string> names;
  for (const Unit& unit : kUnits)
    if (ours == unit.ours) names.emplace_back(unit.name);
  return "one of " + files::joined(names);
}

/// A text that must be there.
std::string needed(Table& table, const std::string& key, const char* what) {
  const std::string text = table.text(key, "");
  if (text.empty()) table.fail(key, what);
  return text;
}

bool flag(Table& table, const std::string& key) {
  const json& value = table.raw(key);
  if (!value.is_null() && !value.is_boolean()) table.fail(key, "true or false");
  return value.is_boolean() && value.get<bool>();
}

/// @param ours  the unit of the result.
Source source_in(Table table, const TomlFile& file, const std::string& pointer,
                 std::string_view ours) {
  constexpr double kMost = 1e12;
  Source source;
  source.place = file.place(pointer);
  source.column = needed(table, "column", "a column's name");
  source.table = table.text("table", "");
  const std::string unit = table.text("unit", "");
  const auto known = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& one) {
    return unit == one.name && ours == one.ours;
  });
  if (known == kUnits.end()) table.fail("unit", units_for(ours));
  const double scale = table.number("scale", -kMost, kMost, 1.0);
  if (scale == 0.0) table.fail("scale", "another number than 0");
  const int sign = table.integer("sign", -1, 1, 1);
  if (sign == 0) table.fail("sign", "1 or -1");
  source.factor = scale * sign * known->factor;
  source.zero = table.number("zero", -kMost, kMost, 0.0);
  source.on_change = flag(table, "on_change");
  source.from_start = flag(table, "from_start");
  table.refuse_others();
  return source;
}

/// A table, or a list of tables of which the first counts that the log has.
template <class Read>
void each_choice(Table& table, const std::string& key, const std::string& pointer, Read&& read) {
  const json& value = table.raw(key);
  if (!value.is_array()) {
    read(table.table(key), pointer + "/" + key);
    return;
  }
  if (value.empty()) table.fail(key, "a table or a list of them");
  for (std::size_t i = 0; i < value.size(); ++i)
    read(table.item(key, i, key + ", choice " + std::to_string(i + 1)),
         pointer + "/" + key + "/" + std::to_string(i));
}

QuaternionSource quaternion_in(Table table, const TomlFile& file, const std::string& pointer) {
  QuaternionSource source;
  source.place = file.place(pointer);
  source.table = table.text("table", "");
  const json& names = table.raw("wxyz");
  const bool usable =
      names.is_array() && names.size() == 4 &&
      std::all_of(names.begin(), names.end(), [](const json& name) { return name.is_string(); });
  if (!usable) table.fail("wxyz", "the names of four columns");
  for (std::size_t i = 0; i < 4; ++i) source.columns[i] = names[i].get<std::string>();
  const std::string axes = table.text("axes", "");
  if (axes == "frd-ned")
    source.axes = Axes::kFrdNed;
  else if (axes == "flu-nwu")
    source.axes = Axes::kFluNwu;
  else if (axes == "flu-enu")
    source.axes = Axes::kFluEnu;
  else
    table.fail("axes", "one of frd-ned, flu-nwu, flu-enu");
  table.refuse_others();
  return source;
}

/// "time = {column = "timestamp", unit = "us"}", or with columns and units that add up.
TimeColumns time_in(Table table) {
  TimeColumns time;
  const auto texts = [&](const char* one, const char* many) {
    std::vector<std::string> list;
    if (table.has(one)) return std::vector{needed(table, one, "text")};
    const json& value = table.raw(many);
    if (!value.is_array() || value.empty()) table.fail(one, "text");
    for (const json& text : value) {
      if (!text.is_string()) table.fail(many, "a list of texts");
      list.push_back(text.get<std::string>());
    }
    return list;
  };
  time.columns = texts("column", "columns");
  time.units = texts("unit", "units");
  const char* const key = table.has("unit") ? "unit" : "units";
  if (time.columns.size() != time.units.size()) table.fail(key, "as many as there are columns");
  for (const std::string& unit : time.units)
    if (std::find(kTimeUnits.begin(), kTimeUnits.end(), unit) == kTimeUnits.end())
      table.fail(key, names_in(kTimeUnits));
  table.refuse_others();
  return time;
}

std::chrono::nanoseconds seconds_in(Table& table, const char* key) {
  constexpr double kMost = 4e9;  // since 1970
  return std::chrono::nanoseconds{std::llround(1e9 * table.number(key, -kMost, kMost, 0.0))};
}

PictureSource pictures_in(Table table) {
  constexpr double kLatest = 10'000.0;  // [ms]
  PictureSource pictures;
  pictures.folder = table.text("folder", "");
  pictures.unit = table.text("stamp", pictures.unit);
  if (std::find(kTimeUnits.begin(), kTimeUnits.end(), pictures.unit) == kTimeUnits.end())
    table.fail("stamp", names_in(kTimeUnits));
  pictures.delay =
      std::chrono::nanoseconds{std::llround(1e6 * table.number("delay_ms", 0.0, kLatest, 0.0))};
  pictures.offset = seconds_in(table, "clock_offset_s");
  table.refuse_others();
  return pictures;
}

}  // namespace

const std::vector<std::string>& known_columns() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Known& known : kKnown) names.emplace_back(known.column);
    return names;
  }();
  return kNames;
}

std::string_view unit_of(const std::string& column) {
  for (const Known& known : kKnown)
    if (column == known.column) return known.unit;
  return "";
}

Mapping read_mapping(const std::filesystem::path& path) {
  const TomlFile file{path};
  Table top{file};
  Mapping mapping;
  mapping.file = path;

  if (!top.has("log")) top.fail("log", "a table");
  Table log = top.table("log");
  const std::string kind = log.text("kind", "");
  if (kind == "csv")
    mapping.kind = Mapping::Kind::kCsv;
  else if (kind == "ulog")
    mapping.kind = Mapping::Kind::kUlog;
  else if (kind == "folder")
    mapping.kind = Mapping::Kind::kFolder;
  else
    log.fail("kind", "one of csv, ulog, folder");
  mapping.table = log.text("table", "");
  if (mapping.kind == Mapping::Kind::kCsv && !mapping.table.empty())
    log.fail("table", "left out: a csv has but one");
  if (mapping.kind != Mapping::Kind::kCsv && mapping.table.empty())
    log.fail("table", "the name of the table whose rows become the flight's");
  each_choice(log, "time", "/log",
              [&](Table table, const std::string&) { mapping.time.push_back(time_in(table)); });
  log.refuse_others();

  if (!top.has("columns")) top.fail("columns", "a table");
  Table columns = top.table("columns");
  for (const Known& known : kKnown) {
    if (!columns.has(known.column)) continue;
    each_choice(columns, known.column, "/columns", [&](Table table, const std::string& pointer) {
      mapping.columns[known.column].push_back(source_in(table, file, pointer, known.unit));
    });
  }
  for (const char* attitude : {"ahrs", "true"}) {
    const std::string key = std::string{attitude} + "_attitude";
    if (!columns.has(key)) continue;
    each_choice(columns, key, "/columns", [&](Table table, const std::string& pointer) {
      mapping.quaternions[attitude].push_back(quaternion_in(table, file, pointer));
    });
  }
  for (std::size_t i = 0; i < 6; ++i)
    if (!columns.has(kKnown[i].column))
      columns.fail(kKnown[i].column, "a table: no flight is without its IMU");
  columns.refuse_others();

  if (top.has("lifted")) {
    Table lifted = top.table("lifted");
    constexpr double kMost = 1e12;
    const bool below = lifted.has("below");
    if (!below && !lifted.has("above")) lifted.fail("above", "a number");
    Source source;
    source.factor = below ? -1.0 : 1.0;
    mapping.lifted_above = source.factor * lifted.number(below ? "below" : "above", -kMost, kMost);
    source.place = file.place("/lifted");
    source.column = needed(lifted, "column", "a column's name");
    source.table = lifted.text("table", "");
    lifted.refuse_others();
    mapping.lifted = source;
  }
  if (top.has("pictures")) mapping.pictures = pictures_in(top.table("pictures"));
  top.refuse_others();
  return mapping;
}

}  // namespace gatefly::foreign_logs
