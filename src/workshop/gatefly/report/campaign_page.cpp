// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/campaign_page.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/files/json_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/report/index_page.hpp"
#include "gatefly/report/list_page.hpp"
#include "gatefly/report/page.hpp"

namespace gatefly::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostEntries = 20'000;  // of a folder that is looked through

/// An object, or nothing: a file that is missing, cut off or something else.
std::optional<Json> object_in(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  try {
    Json json = files::read_json(path);
    if (json.is_object()) return json;
  } catch (const std::runtime_error&) {  // not readable, damaged
  }
  return std::nullopt;
}

bool is_flight(const Json& summary) {
  return summary.contains("gates_passed") && summary.contains("gates_total");
}

bool is_campaign(const Json& json) {
  return json.contains("arguments") && json.at("arguments").is_object() && json.contains("result");
}

std::string text_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string{};
}

bool has_page(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "report.html", error);
}

/// When a file was last written, as seconds since 1970; 0: nobody knows.
std::int64_t changed(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error);
  if (error) return 0;
  const auto system = std::chrono::file_clock::to_sys(time).time_since_epoch();
  return std::chrono::duration_cast<std::chrono::seconds>(system).count();
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::directory_iterator entry{folder, error}, end; !error && entry != end;
       entry.increment(error)) {
    paths.push_back(entry->path());
    if (paths.size() == kMostEntries) break;
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// A name or argument as a shell takes it.
std::string quoted(const std::string& text) {
  if (text.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._/-") ==
      std::string::npos)
    return text;
  std::string all = "'";
  for (const char letter : text) all += letter == '\'' ? std::string{"'\\''"} : std::string{letter};
  return all + "'";
}

/// run_000017.json of a campaign.
ListedFlight run_in(const fs::path& file, const fs::path& folder, const std::string& track,
                    std::string fly) {
  ListedFlight flight;
  const std::string digits = file.stem().string().substr(4);
  const std::string seed =
      digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1));
  flight.name = track + "-" + seed;
  if (const auto summary = object_in(file))
    flight.summary = *summary;
  else
    flight.note = file.filename().string() + " is damaged";
  if (has_page(folder / flight.name)) flight.page = flight.name + "/report.html";
  if (const auto at = fly.find("{seed}"); at != std::string::npos) {
    fly.replace(at, 6, seed);
    flight.fly = fly + " --out " + quoted((folder / flight.name).string());
  }
  return flight;
}

bool is_run(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.size() > 9 && name.starts_with("run_") && name.ends_with(".json") &&
         name.find_first_not_of("0123456789", 4) == name.size() - 5;
}

}  // namespace

std::string campaign_page(const fs::path& folder) {
  const auto campaign = object_in(folder / "campaign.json");
  if (!campaign || !is_campaign(*campaign))
    throw std::runtime_error((folder / "campaign.json").string() + ": is damaged");
  const Json& arguments = campaign->at("arguments");
  const std::string track = text_in(arguments, "track"), fly = text_in(*campaign, "fly");
  std::vector<ListedFlight> runs;
  for (const fs::path& path : entries(folder))
    if (is_run(path)) runs.push_back(run_in(path, folder, track, fly));
  const std::string title = track + ", " + std::to_string(runs.size()) +
                            (runs.size() == 1 ? " run, " : " runs, ") +
                            text_in(arguments, "vision") + " vision";
  return list_page(shipped_page("campaign.html"), title, *campaign, runs);
}

std::string folder_page(const fs::path& folder) {
  std::vector<IndexEntry> index;
  std::error_code error;
  for (const fs::path& path : entries(folder)) {
    if (!fs::is_directory(path, error)) continue;
    IndexEntry entry{.name = path.filename().string()};
    entry.changed = changed(path / "summary.json");
    if (const auto campaign = object_in(path / "campaign.json");
        campaign && is_campaign(*campaign)) {
      entry.kind = IndexEntry::Kind::kCampaign;
      entry.summary = *campaign;
      entry.page = entry.name + "/";  // made anew when it is asked for
      entry.changed = changed(path / "campaign.json");
    } else if (const auto summary = object_in(path / "summary.json");
               summary && is_flight(*summary)) {
      if (text_in(*summary, "kind") == "replay") entry.kind = IndexEntry::Kind::kReplay;
      entry.summary = *summary;
      if (!has_page(path)) entry.note = "no report.html: flown by an older gatefly";
    } else if (fs::exists(path / "campaign.json", error)) {
      entry.kind = IndexEntry::Kind::kCampaign;
      entry.note = "campaign.json is damaged, or not a campaign's";
    } else if (fs::exists(path / "summary.json", error)) {
      entry.note = "summary.json is damaged, or not a flight's";
    } else {
      continue;
    }
    if (entry.kind != IndexEntry::Kind::kCampaign && has_page(path))
      entry.page = entry.name + "/report.html";
    if (fs::is_regular_file(path / "flight.mp4", error)) entry.film = entry.name + "/flight.mp4";
    index.push_back(std::move(entry));
  }
  return index_page(fs::absolute(folder).lexically_normal().string(), index);
}

Viewable viewable(const fs::path& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) throw std::runtime_error(path.string() + ": is not there");
  if (!fs::is_directory(status))
    throw std::runtime_error(path.string() +
                             ": is no folder; give a flight, a folder of flights, or a campaign");
  if (fs::exists(path / "campaign.json", error)) {
    const auto campaign = object_in(path / "campaign.json");
    if (!campaign || !is_campaign(*campaign))
      throw std::runtime_error((path / "campaign.json").string() +
                               ": is damaged, or not a campaign's");
    return Viewable::kCampaign;
  }
  if (fs::exists(path / "summary.json", error)) {
    const auto summary = object_in(path / "summary.json");
    if (!summary || !is_flight(*summary))
      throw std::runtime_error((path / "summary.json").string() +
                               ": is damaged, or not a flight's");
    if (!has_page(path))
      throw std::runtime_error(path.string() +
                               ": has no report.html: flown by an older gatefly; `gatefly replay " +
                               quoted(path.string()) + " --out DIR` makes one");
    return Viewable::kFlight;
  }
  for (const fs::path& entry : entries(path)) {
    if (!fs::is_directory(entry, error)) continue;
    if (fs::exists(entry / "summary.json", error) || fs::exists(entry / "campaign.json", error))
      return Viewable::kFolder;
  }
  throw std::runtime_error(path.string() + ": holds no flight and no campaign of gatefly");
}

}  // namespace gatefly::report
