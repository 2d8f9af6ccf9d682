// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/list_page.hpp"

#include <cmath>
#include <cstddef>
#include <string_view>

#include "gatefly/report/page.hpp"

namespace gatefly::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostFlights = 10'000;  // a row each, 250 bytes

/// A table's row from a race's summary.json, without fields that are missing or not as they should
/// be.
Json row_of(const ListedFlight& flight) {
  Json row{{"name", flight.name}};
  if (!flight.page.empty()) row["page"] = flight.page;
  if (!flight.fly.empty()) row["fly"] = flight.fly;
  if (!flight.note.empty()) row["note"] = flight.note;
  const nlohmann::json& s = flight.summary;
  if (!s.is_object()) return row;
  const auto copy = [&](const char* from, const char* to, auto is_right) {
    if (const auto found = s.find(from); found != s.end() && is_right(*found)) row[to] = *found;
  };
  const auto number = [](const nlohmann::json& value) { return value.is_number(); };
  const auto text = [](const nlohmann::json& value) { return value.is_string(); };
  copy("seed", "seed", number);
  copy("kind", "kind", text);
  copy("finished", "finished", [](const nlohmann::json& value) { return value.is_boolean(); });
  copy("gates_passed", "gates", number);
  copy("gates_total", "gates_total", number);
  copy("race_time_s", "time_s", number);
  copy("mean_speed_mps", "speed_mps", number);
  copy("stop_reason", "stop", text);
  copy("abort_reason", "why", text);
  if (const auto crash = s.find("crash"); crash != s.end() && crash->is_object())
    if (const auto object = crash->find("object"); object != crash->end() && object->is_string())
      row["why"] = *object;
  if (const auto lost = s.find("why_lost"); lost != s.end() && lost->is_object()) {
    const auto copy_text = [&](const char* from, const char* to) {
      if (const auto found = lost->find(from); found != lost->end() && found->is_string())
        row[to] = *found;
    };
    copy_text("line", "lost");
    copy_text("cause", "lost_by");
  }
  double error2 = 0.0;
  if (const auto rmse = s.find("estimation_rmse_m"); rmse != s.end() && rmse->is_array())
    for (const auto& axis : *rmse)
      if (axis.is_number()) error2 += axis.get<double>() * axis.get<double>();
  if (error2 > 0.0) row["rmse_m"] = std::round(1e3 * std::sqrt(error2)) / 1e3;
  return row;
}

/// Offsets at the gates' planes: to the right and down, in whole centimetres.
void add_offsets(const nlohmann::json& summary, Json& across, Json& down) {
  if (!summary.is_object() || !summary.contains("gate_offsets_m")) return;
  for (const auto& offset : summary.at("gate_offsets_m"))
    if (offset.is_array() && offset.size() == 2 && offset[0].is_number() && offset[1].is_number()) {
      across.push_back(std::lround(100.0 * offset[0].get<double>()));
      down.push_back(std::lround(100.0 * offset[1].get<double>()));
    }
}

}  // namespace

std::string list_page(const std::string& page, const std::string& title, const Json& campaign,
                      const std::vector<ListedFlight>& flights) {
  Json rows = Json::array(), across = Json::array(), down = Json::array();
  const std::size_t step = flights.size() / kMostFlights + 1;
  for (std::size_t i = 0; i < flights.size(); i += step) {
    rows.push_back(row_of(flights[i]));
    add_offsets(flights[i].summary, across, down);
  }
  Json data{{"title", title},
            {"flights", std::move(rows)},
            {"one_in", step},
            {"offsets_cm", {{"across", std::move(across)}, {"down", std::move(down)}}},
            {"result", nullptr}};
  if (campaign.is_object()) {
    data["result"] = campaign.value("result", Json(nullptr));
    data["arguments"] = campaign.value("arguments", Json(nullptr));
    if (data["arguments"].is_object()) data["arguments"].erase("track_toml");
    if (data["arguments"].is_object()) data["arguments"].erase("color_table");
  }
  return with_data(page, {{"list", data}});
}

std::string comparison_page(const std::string& page, const std::string& title,
                            const Json& comparison) {
  return with_data(page, {{"list",
                           {{"title", title},
                            {"flights", Json::array()},
                            {"one_in", 1},
                            {"offsets_cm", {{"across", Json::array()}, {"down", Json::array()}}},
                            {"result", nullptr},
                            {"comparison", comparison}}}});
}

}  // namespace gatefly::report
