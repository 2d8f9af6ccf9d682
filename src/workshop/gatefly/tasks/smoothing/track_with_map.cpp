// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/track_with_map.hpp"

#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::smoothing {
namespace {

using nlohmann::json;

bool is_table_list(const json& value) {
  return value.is_array() && !value.empty() && value.front().is_object();
}

// JSON's numbers are TOML's, and so are its strings.
std::string text_of(const json& value) {
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const json& item : value) text += (text.empty() ? "" : ", ") + text_of(item);
  return '[' + text + ']';
}

void write_values(std::string& text, const json& table) {
  for (const auto& [key, value] : table.items())
    if (!value.is_object() && !is_table_list(value)) text += key + " = " + text_of(value) + '\n';
}

void write_tables(std::string& text, const json& table, const std::string& before) {
  for (const auto& [key, value] : table.items()) {
    if (value.is_object()) {
      text += "\n[" + before + key + "]\n";
      write_values(text, value);
      write_tables(text, value, before + key + '.');
    }
    if (!is_table_list(value)) continue;
    for (const json& item : value) {
      text += "\n[[" + before + key + "]]\n";
      write_values(text, item);
      write_tables(text, item, before + key + '.');
    }
  }
}

double rounded(double value, double step) { return std::round(value / step) * step; }

// As a person would write it: "1.234", not "1.2340000000000000".
json number(double value, double step) {
  return json::parse(files::text_of(rounded(value, step), 9));
}

}  // namespace

Track with_map(Track track, const LearntMap& map, const Intake& intake) {
  const eskf::Landmarks known{intake.setup.map, intake.setup.params.priors};
  for (MapGate& gate : track.gates) {
    const eskf::Landmarks::Face face = known.face_of(gate.p_EG, gate.yaw_EG);
    const LearntGate& learnt = map.gates[face.landmark];
    const eskf::Landmark& before = known.map(face.landmark);
    const double turned = learnt.belief.yaw_EG - before.yaw_EG;
    gate.p_EG += learnt.belief.p_EG - before.p_EG;
    gate.yaw_EG = wrap_angle(gate.yaw_EG + turned);
    gate.side *= 1.0 + learnt.belief.size;
    gate.position_sigma = learnt.sigmas.head<3>();
    gate.yaw_sigma = learnt.sigmas(eskf::kGateYaw);
    gate.side_sigma = gate.side * learnt.sigmas(eskf::kGateSize);
  }
  return track;
}

std::string track_file_with(const std::filesystem::path& path, const Track& learnt,
                            const std::vector<std::string>& from) {
  constexpr double kPlace = 1e-3, kAngle = 0.01, kSide = 1e-4;  // [m], [deg], [m]
  json track = files::TomlFile{path}.content();
  if (!track.contains("name")) track["name"] = learnt.name;
  json& gates = track.at("gates");
  if (gates.size() != learnt.gates.size())
    throw std::runtime_error(path.string() + ": has changed meanwhile");
  for (std::size_t i = 0; i < gates.size(); ++i) {
    const MapGate& gate = learnt.gates[i];
    const auto three = [&](const Eigen::Vector3d& v) {
      return json::array({number(v.x(), kPlace), number(v.y(), kPlace), number(v.z(), kPlace)});
    };
    gates[i]["position_m"] = three(gate.p_EG);
    gates[i]["heading_deg"] = number(gate.yaw_EG / kDegree, kAngle);
    gates[i]["side_m"] = number(gate.side, kSide);
    if (gate.position_sigma) gates[i]["position_sigma_m"] = three(*gate.position_sigma);
    if (gate.yaw_sigma) gates[i]["heading_sigma_deg"] = number(*gate.yaw_sigma / kDegree, kAngle);
    if (gate.side_sigma) gates[i]["side_sigma_m"] = number(*gate.side_sigma, kSide);
  }
  std::string text = std::string{kLearntTrack} + " from " +
                     files::one_line(path.filename().string()) + " and these flights:\n";
  for (const std::string& flight : from) text += "#   " + files::one_line(flight) + '\n';
  write_values(text, track);
  write_tables(text, track, "");
  return text;
}

}  // namespace gatefly::smoothing
