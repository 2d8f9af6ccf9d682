// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/index_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <optional>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/report/index_look.hpp"

namespace gatefly::report {
namespace {

using Kind = IndexEntry::Kind;

constexpr std::size_t kMostIndexRows = 10'000;  // 600 bytes each

/// Text in a page or in a quoted attribute of it; what is no UTF-8 as a browser shows it.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// A path in an address: "a flight?/" is "a%20flight%3F/"; "./" before it, or "a:b" would be a scheme.
std::string address_of(const std::string& path) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~/";
  std::string result = path.find(':') < path.find('/') ? "./" : "";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (kPlain.find(c) != std::string_view::npos)
      result += c;
    else
      result += std::string{"%"} + "0123456789ABCDEF"[byte >> 4] + "0123456789ABCDEF"[byte & 15];
  }
  return result;
}

/// A member of an object that may be anything.
const nlohmann::json& at(const nlohmann::json& object, const char* key) {
  static const nlohmann::json kNoValue;
  if (!object.is_object()) return kNoValue;
  const auto found = object.find(key);
  return found == object.end() ? kNoValue : *found;
}

std::string text_at(const nlohmann::json& object, const char* key) {
  const nlohmann::json& value = at(object, key);
  return value.is_string() ? files::one_line(value.get<std::string>(), 200) : std::string{};
}

std::optional<double> number_at(const nlohmann::json& object, const char* key) {
  const nlohmann::json& value = at(object, key);
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  return std::isfinite(number) ? std::optional{number} : std::nullopt;
}

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::kFlight:
      break;
    case Kind::kReplay:
      return "replay";
    case Kind::kCampaign:
      return "campaign";
  }
  return "flight";
}

/// Its outcome, and what that means.
struct Outcome {
  std::string text;
  const char* look = "muted";  ///< good, bad or muted.
};

Outcome outcome_of(const IndexEntry& entry) {
  if (!entry.summary.is_object()) return {entry.note, "bad"};
  if (entry.kind == Kind::kReplay) return {"flown again by its sensors"};
  if (entry.kind == Kind::kCampaign) {
    const nlohmann::json& result = at(entry.summary, "result");
    const auto runs = number_at(result, "runs"), finished = number_at(result, "finished");
    if (!runs || !finished) return {"not yet whole"};
    return {files::fixed(*finished, 0) + " of " + files::fixed(*runs, 0) + " races finished",
            *finished == *runs ? "good" : "muted"};
  }
  const nlohmann::json& finished = at(entry.summary, "finished");
  if (!finished.is_boolean()) return {};
  if (finished.get<bool>()) return {"finished", "good"};
  const std::string stop = text_at(entry.summary, "stop_reason");
  if (stop == "crash")
    return {"crashed into " + text_at(at(entry.summary, "crash"), "object"), "bad"};
  if (stop == "abort") return {"given up: " + text_at(entry.summary, "abort_reason"), "bad"};
  return {stop.empty() ? "not finished" : stop, "bad"};
}

std::optional<double> error_of(const nlohmann::json& summary) {
  const nlohmann::json& rmse = at(summary, "estimation_rmse_m");
  if (!rmse.is_array()) return std::nullopt;
  double error2 = 0.0;
  for (const nlohmann::json& axis : rmse)
    if (axis.is_number()) error2 += axis.get<double>() * axis.get<double>();
  return error2 > 0.0 && std::isfinite(error2) ? std::optional{std::sqrt(error2)} : std::nullopt;
}

/// "2026-11-23T15:04:05Z".
std::string utc(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm parts{};
  std::array<char, 32> text{};
  if (gmtime_r(&time, &parts) == nullptr) return {};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

std::string number_cell(const char* label, const std::string& number, const std::string& shown) {
  return "<td class=\"number\" data-label=\"" + std::string{label} + "\" data-sort=\"" + number +
         "\">" + shown + "</td>";
}

std::string number_cell(const char* label, const std::optional<double>& value, int digits,
                        const std::string& unit) {
  const std::string text = value ? files::fixed(*value, digits) : std::string{};
  return number_cell(label, text, value ? text + unit : text);
}

std::string gates_cell(const nlohmann::json& summary) {
  const auto passed = number_at(summary, "gates_passed"), all = number_at(summary, "gates_total");
  if (!passed || !all) return number_cell("gates", "", "");
  return number_cell("gates", files::fixed(*passed, 0),
                     files::fixed(*passed, 0) + " of " + files::fixed(*all, 0));
}

std::string link(const std::string& path, const std::string& text) {
  return path.empty() ? escaped(text)
                      : "<a href=\"" + escaped(address_of(path)) + "\">" + escaped(text) + "</a>";
}

std::string row_of(const IndexEntry& entry) {
  const Outcome outcome = outcome_of(entry);
  const bool flight = entry.kind == Kind::kFlight;
  const nlohmann::json nothing, &s = flight ? entry.summary : nothing;
  const bool lost = flight && s.is_object() && std::string_view{outcome.look} == "bad";
  std::string note = outcome.text;
  if (!entry.note.empty() && entry.note != note) note += (note.empty() ? "" : "; ") + entry.note;
  const std::string track = entry.kind == Kind::kCampaign
                                ? text_at(at(entry.summary, "arguments"), "track")
                                : text_at(entry.summary, "track");
  const std::string seed = at(s, "seed").is_number_integer() ? at(s, "seed").dump() : "";
  std::string row =
      std::string{"<tr data-kind=\""} + name_of(entry.kind) + (lost ? " lost" : "") +
      "\"><td data-sort=\"" + escaped(entry.name) + "\">" + link(entry.page, entry.name) +
      "</td><td>" + (entry.summary.is_object() ? name_of(entry.kind) : "damaged") + "</td><td>" +
      escaped(track) + "</td>" + number_cell("seed", seed, seed) + "<td class=\"what " +
      outcome.look + "\">" + escaped(note) + "</td>" + gates_cell(s) +
      number_cell("time", lost ? std::nullopt : number_at(s, "race_time_s"), 1, " s") +
      number_cell("speed", number_at(s, "mean_speed_mps"), 2, " m/s") +
      number_cell("error", error_of(s), 2, " m") + "<td>" +
      (entry.film.empty() ? "" : link(entry.film, "film")) + "</td>";
  const std::string when = entry.changed > 0 ? utc(entry.changed) : "";
  return row + "<td class=\"muted\" data-sort=\"" +
         (entry.changed > 0 ? std::to_string(entry.changed) : "") + "\">" +
         (when.empty() ? "" : "<time datetime=\"" + when + "\">" + when + "</time>") +
         "</td></tr>\n";
}

/// "12 flights, 9 finished; 1 replay; 2 campaigns; 1 damaged".
std::string counted(const std::vector<IndexEntry>& entries) {
  std::size_t flights = 0, finished = 0, replays = 0, campaigns = 0, damaged = 0;
  for (const IndexEntry& entry : entries) {
    if (!entry.summary.is_object()) {
      ++damaged;
      continue;
    }
    flights += entry.kind == Kind::kFlight;
    replays += entry.kind == Kind::kReplay;
    campaigns += entry.kind == Kind::kCampaign;
    const nlohmann::json& done = at(entry.summary, "finished");
    finished += entry.kind == Kind::kFlight && done.is_boolean() && done.get<bool>();
  }
  std::vector<std::string> parts;
  if (flights > 0)
    parts.push_back(files::amount(flights, "flight") + ", " + std::to_string(finished) +
                    " finished");
  if (replays > 0) parts.push_back(files::amount(replays, "replay"));
  if (campaigns > 0) parts.push_back(files::amount(campaigns, "campaign"));
  if (damaged > 0) parts.push_back(std::to_string(damaged) + " damaged");
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : "; ") + part;
  return all;
}

}  // namespace

std::string index_page(const std::string& title, const std::vector<IndexEntry>& entries) {
  const std::string count = counted(entries);
  std::string page =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>" +
      escaped(title) + " · gatefly</title>\n<style>" + kIndexStyle +
      "</style>\n</head>\n<body>\n<header><div class=\"bar\"><span class=\"brand\">gatefly</span>"
      "<span>" +
      escaped(title) + "</span></div>\n<h1>" + escaped(count) +
      "</h1></header>\n<main><form hidden onsubmit=\"return false\">"
      "<input id=\"words\" type=\"search\" placeholder=\"filter: crash, oval, 17 …\" "
      "aria-label=\"words that a line must have\">"
      "<select id=\"kind\" aria-label=\"what is shown\"><option value=\"\">all</option>"
      "<option value=\"flight\">flights</option><option value=\"lost\">lost flights</option>"
      "<option value=\"replay\">replays</option><option value=\"campaign\">campaigns</option>"
      "</select><select id=\"order\" aria-label=\"in which order\"></select>"
      "<span id=\"shown\" role=\"status\"></span></form>\n"
      "<div class=\"panel\"><table><thead><tr><th>name</th><th>kind</th><th>track</th>"
      "<th class=\"number\">seed</th><th>what became of it</th><th class=\"number\" data-down>gates"
      "</th><th class=\"number\">race time</th><th class=\"number\" data-down>mean speed</th>"
      "<th class=\"number\">position error</th><th>film</th><th data-numbers data-down>written</th>"
      "</tr></thead>\n<tbody>\n";
  const std::size_t rows = std::min(entries.size(), kMostIndexRows);
  for (std::size_t i = 0; i < rows; ++i) page += row_of(entries[i]);
  page += "</tbody></table></div>\n";
  if (rows < entries.size())
    page += "<p class=\"muted\">The first " + std::to_string(rows) + " of " +
            std::to_string(entries.size()) + " are shown.</p>\n";
  return page + "</main>\n<script>" + kIndexScript + "</script>\n</body>\n</html>\n";
}

}  // namespace gatefly::report
