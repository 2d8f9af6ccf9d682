// SPDX-License-Identifier: Apache-2.0
#include "campaign_folder.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "gatefly/config/config.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/json_file.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/partial_folder.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/report/campaign_page.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

/// A run that is whole, of another program.
class AnotherCommit : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

constexpr std::uint64_t kMostRuns = 1'000'000;  // as --runs allows

/// campaign.json, with everything that is asked of it later there and of its type.
nlohmann::json read_campaign(const fs::path& path) {
  const std::string file = (path / "campaign.json").string();
  nlohmann::ordered_json json = files::read_json(file);
  const files::JsonObject campaign(file, json), arguments = campaign.object("arguments");
  const auto runs = arguments.whole("runs", 1, kMostRuns);
  (void)arguments.whole("first_seed", 0, std::numeric_limits<std::uint64_t>::max() - (runs - 1));
  const auto shard = arguments.wholes("shard", 2, 1, kMostRuns);
  if (shard[0] > shard[1]) arguments.fail("shard", "[i, n] with i at most n");
  for (const char* name : {"track", "vision"}) (void)arguments.text(name);
  for (const char* name : {"version", "commit"}) (void)arguments.text(name, "");
  if (arguments.has("config")) (void)arguments.object("config");
  (void)campaign.text("fly");
  nlohmann::json whole = std::move(json);
  if (nlohmann::json& given = whole["arguments"]; given.contains("config"))
    given["config"] = config::with_current_names(given["config"]);
  return whole;
}

/// The first argument in which two campaigns differ, in words; "" when they are the same.
std::string difference(const nlohmann::json& stored, const nlohmann::json& given) {
  if (stored == given) return "";
  const auto a = stored.flatten(), b = given.flatten();
  for (const auto& [key, value] : b.items()) {
    if (a.contains(key) && a.at(key) == value) continue;
    std::string name = key.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    if (name == "track_toml") return "the track file has changed";
    if (name == "color_table") return "the colour table has changed";
    return files::one_line(name, 100) + " was " +
           (a.contains(key) ? files::shown(a.at(key)) : "not there") + ", is " +
           files::shown(value);
  }
  return "it has more arguments";
}

}  // namespace

CampaignFolder::CampaignFolder(fs::path path, nlohmann::json arguments, std::string fly)
    : path_{std::move(path)},
      arguments_(std::move(arguments)),
      fly_{std::move(fly)} {}  // braces would make an array

bool CampaignFolder::is_there() const {
  files::check_output_folder("--out", path_);
  std::error_code error;
  if (!fs::exists(path_ / "campaign.json", error)) {
    files::refuse_foreign_folder(path_, "campaign.json", {"campaign", ""}, "choose another --out");
    return false;
  }
  const std::string other = difference(read_campaign(path_).at("arguments"), arguments_);
  if (!other.empty())
    throw std::runtime_error(path_.string() + ": holds a campaign with other arguments (" + other +
                             "), choose another --out");
  return true;
}

CampaignFolder CampaignFolder::opened(fs::path path, nlohmann::json arguments, std::string fly) {
  CampaignFolder folder(std::move(path), std::move(arguments), std::move(fly));
  if (folder.is_there()) return folder;
  std::error_code error;
  fs::create_directories(folder.path_, error);
  if (error)
    throw std::runtime_error(folder.path_.string() + ": cannot be written: " + error.message());
  try {
    files::write_file(folder.path_ / "campaign.json", files::json_text(folder.as_json()));
  } catch (const files::CannotWrite&) {
    fs::remove(folder.path_, error);
    throw;
  }
  return folder;
}

CampaignFolder CampaignFolder::existing(const fs::path& path) {
  const nlohmann::json campaign = read_campaign(path);
  return {path, campaign.at("arguments"), campaign.at("fly")};
}

nlohmann::ordered_json CampaignFolder::as_json() const {
  nlohmann::ordered_json json;
  json["arguments"] = arguments_;
  json["fly"] = fly_;
  json["result"] = nullptr;
  return json;
}

std::vector<std::uint64_t> CampaignFolder::seeds() const {
  const auto first = arguments_.at("first_seed").get<std::uint64_t>(),
             runs = arguments_.at("runs").get<std::uint64_t>();
  const auto index = arguments_.at("shard").at(0).get<std::uint64_t>(),
             count = arguments_.at("shard").at(1).get<std::uint64_t>();
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t i = index - 1; i < runs; i += count) seeds.push_back(first + i);
  return seeds;
}

fs::path CampaignFolder::file_of(std::uint64_t seed) const {
  const std::string number = std::to_string(seed);
  return path_ /
         ("run_" + std::string(number.size() < 6 ? 6 - number.size() : 0, '0') + number + ".json");
}

void CampaignFolder::keep(std::uint64_t seed, const std::string& summary_json) const {
  files::write_file(file_of(seed), summary_json);
}

std::optional<simulated_race::RunRow> CampaignFolder::row(std::uint64_t seed) const {
  if (!fs::exists(file_of(seed))) return std::nullopt;
  const std::string file = file_of(seed).string();
  simulated_race::RunRow row = simulated_race::row_of(files::read_json(file), file);
  if (row.seed != seed)
    throw std::runtime_error(file + ": seed = " + std::to_string(row.seed) + ", must be " +
                             std::to_string(seed) + ", as its name says");
  if (const std::string commit = arguments_.value("commit", ""); row.commit != commit)
    throw AnotherCommit(file + ": flown by commit \"" + files::one_line(row.commit) +
                        "\", the campaign by \"" + files::one_line(commit) + "\", take it away");
  return row;
}

bool CampaignFolder::has(std::uint64_t seed) const {
  try {
    return row(seed).has_value();
  } catch (const AnotherCommit&) {
    throw;
  } catch (const std::runtime_error&) {  // damaged by somebody else: as if it were not there
    return false;
  }
}

std::vector<simulated_race::RunRow> CampaignFolder::rows() const {
  std::vector<simulated_race::RunRow> rows;
  for (const std::uint64_t seed : seeds())
    if (auto there = row(seed)) rows.push_back(*std::move(there));
  return rows;
}

nlohmann::ordered_json CampaignFolder::finish(
    const std::vector<simulated_race::RunRow>& rows) const {
  nlohmann::ordered_json json = as_json();
  json["result"] = simulated_race::campaign_result(rows);
  const auto failed = std::find_if(rows.begin(), rows.end(),
                                   [](const simulated_race::RunRow& row) { return !row.finished; });
  if (failed != rows.end()) {
    std::string command = fly_;
    if (const auto at = command.find("{seed}"); at != std::string::npos)
      command.replace(at, 6, std::to_string(failed->seed));
    json["replay"] = command;
  }
  files::write_file(path_ / "runs.csv", simulated_race::runs_csv(rows));
  files::write_file(path_ / "campaign.json", files::json_text(json));
  files::write_file(path_ / "report.html", report::campaign_page(path_));
  return json;
}

CampaignFolder merged(const fs::path& out, const std::vector<fs::path>& shards) {
  std::vector<CampaignFolder> parts;
  for (const fs::path& shard : shards) {
    parts.push_back(CampaignFolder::existing(shard));
    parts.back().arguments_["shard"] = {1, 1};
    const std::string other = difference(parts.front().arguments_, parts.back().arguments_);
    if (!other.empty())
      throw std::runtime_error(shard.string() + ": does not belong to " + shards.front().string() +
                               " (" + other + ")");
  }
  const CampaignFolder whole(out, parts.front().arguments_, parts.front().fly_);
  (void)whole.is_there();
  // Before anything is written: whether all runs are there, and whole.
  std::vector<fs::path> files;
  for (const std::uint64_t seed : whole.seeds()) {
    const auto holder = std::find_if(parts.begin(), parts.end(), [seed](const auto& part) {
      return part.row(seed).has_value();
    });
    if (holder == parts.end())
      throw std::runtime_error("--merge: no folder holds seed " + std::to_string(seed) +
                               "; fly the shard it belongs to");
    files.push_back(holder->file_of(seed));
  }
  catch_interrupt();
  files::PartialFolder folder(
      out, files::PartialFolder::Grows::kInside,
      [](const std::string& name) { return name == "campaign.json" || name.starts_with("run_"); });
  for (const fs::path& file : files) {
    stop_if_interrupted();
    folder.write(file.filename(), files::read_file(file));
  }
  folder.write("campaign.json", files::json_text(whole.as_json()));
  folder.pour();
  return whole;
}

}  // namespace gatefly::cli
