// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/findings_json.hpp"

#include <iomanip>
#include <sstream>

#include "gatefly/geometry/math.hpp"

namespace gatefly::flight_log {

nlohmann::ordered_json as_json(const std::optional<eskf::Findings>& findings) {
  using Json = nlohmann::ordered_json;
  if (!findings) return nullptr;
  const auto pair = [](const eskf::Found& one, double unit) {
    return Json::array({one.value / unit, one.sigma / unit});
  };
  Json json{{"camera_tilt_deg", pair(findings->tilt, kDegree)},
            {"camera_pan_deg", pair(findings->pan, kDegree)},
            {"camera_roll_deg", pair(findings->roll, kDegree)},
            {"latency_ms", pair({-findings->delay.value, findings->delay.sigma}, 1e-3)},
            {"focal", pair(findings->focal, 1.0)},
            {"thrust", pair(findings->thrust, 1.0)},
            {"wind_north_mps", pair(findings->wind_north, 1.0)},
            {"wind_east_mps", pair(findings->wind_east, 1.0)},
            {"heading_deg", pair(findings->heading, kDegree)},
            {"gates_off", Json::array()}};
  for (const eskf::GateOff& gate : findings->off)
    json["gates_off"].push_back(
        {{"gate", gate.gate + 1},
         {"along_right_down_m", {gate.offset.x(), gate.offset.y(), gate.offset.z()}},
         {"turned_deg", gate.turned / kDegree},
         {"sigma_m", gate.sigma}});
  return json;
}

std::string text_of(const std::optional<eskf::Findings>& findings) {
  if (!findings) return "";
  std::ostringstream text;
  text << std::fixed << std::showpos;
  const auto put = [&text](const char* what, const eskf::Found& found, double unit, int digits,
                           const char* name) {
    text << what << std::setprecision(digits) << found.value / unit << std::noshowpos << " ("
         << found.sigma / unit << std::showpos << ")" << name;
  };
  put("camera tilt ", findings->tilt, kDegree, 1, "°");
  put(", pan ", findings->pan, kDegree, 1, "°");
  put(", heading ", findings->heading, kDegree, 1, "°");
  put(", pictures ", findings->delay, 1e-3, 0, " ms younger");
  put(", focal ", findings->focal, 0.01, 1, " %");
  put(", thrust ", findings->thrust, 0.01, 1, " %");
  for (const eskf::GateOff& gate : findings->off)
    text << std::setprecision(2) << "; gate " << std::noshowpos << gate.gate + 1 << std::showpos
         << " is not where the map has it: " << gate.offset.x() << " m along its way, "
         << gate.offset.y() << " m right, turned " << std::setprecision(0) << gate.turned / kDegree
         << "°";
  return text.str();
}

}  // namespace gatefly::flight_log
