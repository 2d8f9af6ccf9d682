// SPDX-License-Identifier: Apache-2.0
#include "campaign_folder.hpp"

#include <algorithm>
#include <stdexcept>

#include "gatefly/config/config.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

nlohmann::json read_campaign(const fs::path& path) {
  auto json = nlohmann::json::parse(io::read_file(path / "campaign.json"), nullptr, false);
  const auto has = [&](const char* pointer, auto is_right) {
    const nlohmann::json::json_pointer place{pointer};
    return json.contains(place) && is_right(json.at(place));
  };
  const auto whole = [](const nlohmann::json& value) { return value.is_number_unsigned(); };
  const auto counted = [](const nlohmann::json& value) {
    return value.is_number_unsigned() && value > 0;
  };
  if (!has("/arguments/first_seed", whole) || !has("/arguments/runs", counted) ||
      !has("/arguments/shard/0", counted) || !has("/arguments/shard/1", counted) ||
      !has("/fly", [](const auto& value) { return value.is_string(); }))
    throw std::runtime_error((path / "campaign.json").string() +
                             ": is damaged, choose another --out");
  if (nlohmann::json& arguments = json["arguments"]; arguments.contains("config"))
    arguments["config"] = io::with_current_names(arguments["config"]);
  return json;
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
    return name + " was " + (a.contains(key) ? a.at(key).dump() : "not there") + ", is " +
           value.dump();
  }
  return "it has more arguments";
}

}  // namespace

CampaignFolder::CampaignFolder(fs::path path, nlohmann::json arguments, std::string fly)
    : path_{std::move(path)},
      arguments_(std::move(arguments)),
      fly_{std::move(fly)} {  // braces would make an array
  io::check_output_folder("--out", path_);
  std::error_code error;
  if (fs::exists(path_ / "campaign.json", error)) {
    const std::string other = difference(read_campaign(path_).at("arguments"), arguments_);
    if (!other.empty())
      throw std::runtime_error(path_.string() + ": holds a campaign with other arguments (" +
                               other + "), choose another --out");
    return;
  }
  io::refuse_foreign_folder(path_, "campaign.json", {"campaign", ""}, "choose another --out");
  fs::create_directories(path_, error);
  if (error) throw std::runtime_error(path_.string() + ": cannot be written: " + error.message());
  try {
    io::write_file(path_ / "campaign.json", as_json().dump(2) + "\n");
  } catch (const io::CannotWrite&) {
    fs::remove(path_, error);
    throw;
  }
}

CampaignFolder CampaignFolder::existing(const fs::path& path) {
  const nlohmann::json campaign = read_campaign(path);
  return {path, campaign.at("arguments"), campaign.value("fly", "")};
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
  io::write_file(file_of(seed), summary_json);
}

std::optional<io::RunRow> CampaignFolder::row(std::uint64_t seed) const {
  if (!fs::exists(file_of(seed))) return std::nullopt;
  io::RunRow row;
  try {
    row = io::row_of(nlohmann::json::parse(io::read_file(file_of(seed))));
    if (row.seed != seed) return std::nullopt;
  } catch (const nlohmann::json::exception&) {  // damaged by somebody else: as if it were not there
    return std::nullopt;
  }
  if (const std::string commit = arguments_.value("commit", ""); row.commit != commit)
    throw std::runtime_error(file_of(seed).string() + ": flown by commit \"" + row.commit +
                             "\", the campaign by \"" + commit + "\", take it away");
  return row;
}

std::vector<io::RunRow> CampaignFolder::rows() const {
  std::vector<io::RunRow> rows;
  for (const std::uint64_t seed : seeds())
    if (auto there = row(seed)) rows.push_back(*std::move(there));
  return rows;
}

nlohmann::ordered_json CampaignFolder::finish(const std::vector<io::RunRow>& rows) const {
  nlohmann::ordered_json json = as_json();
  json["result"] = io::campaign_result(rows);
  const auto failed =
      std::find_if(rows.begin(), rows.end(), [](const io::RunRow& row) { return !row.finished; });
  if (failed != rows.end()) {
    std::string command = fly_;
    if (const auto at = command.find("{seed}"); at != std::string::npos)
      command.replace(at, 6, std::to_string(failed->seed));
    json["replay"] = command;
  }
  io::write_file(path_ / "runs.csv", io::runs_csv(rows));
  io::write_file(path_ / "campaign.json", json.dump(2) + "\n");
  return json;
}

CampaignFolder merged(const fs::path& out, const std::vector<fs::path>& shards) {
  nlohmann::json whole;
  std::string fly;
  std::vector<CampaignFolder> parts;
  for (const fs::path& shard : shards) {
    parts.push_back(CampaignFolder::existing(shard));
    nlohmann::json arguments = parts.back().arguments_;
    arguments["shard"] = {1, 1};
    if (whole.is_null()) whole = arguments, fly = parts.back().fly_;
    if (const std::string other = difference(whole, arguments); !other.empty())
      throw std::runtime_error(shard.string() + ": does not belong to " + shards.front().string() +
                               " (" + other + ")");
  }
  // Before anything is written: whether all runs are there.
  const auto holder = [&](std::uint64_t seed) {
    return std::find_if(parts.begin(), parts.end(),
                        [seed](const CampaignFolder& part) { return part.row(seed).has_value(); });
  };
  const auto first = whole.at("first_seed").get<std::uint64_t>(),
             runs = whole.at("runs").get<std::uint64_t>();
  for (std::uint64_t seed = first; seed < first + runs; ++seed)
    if (holder(seed) == parts.end())
      throw std::runtime_error("--merge: no folder holds seed " + std::to_string(seed) +
                               "; fly the shard it belongs to");
  CampaignFolder result(out, whole, fly);
  for (const std::uint64_t seed : result.seeds())
    result.keep(seed, io::read_file(holder(seed)->file_of(seed)));
  return result;
}

}  // namespace gatefly::cli
