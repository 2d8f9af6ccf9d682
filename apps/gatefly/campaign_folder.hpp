// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/simulated_race/results/campaign_statistics.hpp"

namespace gatefly::cli {

/// A campaign on disk: campaign.json (arguments, then the result), run_000017.json a seed,
/// runs.csv,
/// report.html.
///
/// Every file is written under another name and renamed: what is there is whole, so that a campaign
/// that was killed can go on. Everything that is computed, is computed from these files.
class CampaignFolder {
 public:
  /// Makes the folder, or goes on with the campaign in it.
  /// @param arguments  what it is flown with; `first_seed`, `runs` and `shard` say which seeds.
  /// @param fly        the command that flies one of them, "{seed}" in it.
  /// @throws std::runtime_error when it belongs to other arguments or to something else.
  [[nodiscard]] static CampaignFolder opened(std::filesystem::path path, nlohmann::json arguments,
                                             std::string fly);

  /// An existing one, as it is. @throws std::runtime_error when it is none or damaged.
  [[nodiscard]] static CampaignFolder existing(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const nlohmann::json& arguments() const { return arguments_; }
  [[nodiscard]] std::vector<std::uint64_t> seeds() const;

  /// Stores a run; from any thread.
  void keep(std::uint64_t seed, const std::string& summary_json) const;
  /// A stored run; nullopt when there is none.
  /// @throws std::runtime_error when it is damaged, or another commit flew it: no two are mixed.
  [[nodiscard]] std::optional<simulated_race::RunRow> row(std::uint64_t seed) const;
  /// Whether there is a stored run that is not damaged: else it is to be flown (again).
  /// @throws std::runtime_error when another commit flew it.
  [[nodiscard]] bool has(std::uint64_t seed) const;
  /// All runs that are there, by seed. @throws std::runtime_error as row().
  [[nodiscard]] std::vector<simulated_race::RunRow> rows() const;
  [[nodiscard]] std::filesystem::path file_of(std::uint64_t seed) const;

  /// Writes runs.csv, campaign.json and report.html; answers the second.
  nlohmann::ordered_json finish(const std::vector<simulated_race::RunRow>& rows) const;

 private:
  friend CampaignFolder merged(const std::filesystem::path&,
                               const std::vector<std::filesystem::path>&);
  CampaignFolder(std::filesystem::path path, nlohmann::json arguments, std::string fly);
  /// Whether this campaign was begun there. @throws std::runtime_error when it cannot be.
  [[nodiscard]] bool is_there() const;
  [[nodiscard]] nlohmann::ordered_json as_json() const;

  std::filesystem::path path_;
  nlohmann::json arguments_;
  std::string fly_;
};

/// One campaign from the shards of it, whole or not at all.
/// @throws std::runtime_error when they do not belong together, or a run is missing or damaged.
[[nodiscard]] CampaignFolder merged(const std::filesystem::path& out,
                                    const std::vector<std::filesystem::path>& shards);

}  // namespace gatefly::cli
