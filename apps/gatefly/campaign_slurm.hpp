// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gatefly::cli {

inline constexpr std::uint64_t kMostShards = 1001;  ///< Slurm's own default limit of a job array.

/// A campaign that Slurm flies: a job array, one task a shard, and a job that merges them into `out`.
///
/// Beside OUT lies OUT.slurm/: the two job scripts, a folder a shard (1of8, 2of8, ...), their logs, and slurm.json, from
/// which resume_on_slurm() knows what is missing. The machines share the file system that OUT is on.
struct SlurmCampaign {
  std::filesystem::path out;           ///< Folder of the merged campaign.
  std::uint64_t runs = 0, shards = 1;  ///< No more shards than runs.
  int jobs = 1;                        ///< Cores of a task.
  std::string name;                    ///< Name of the job.
  std::string
      words;  ///< "campaign TRACK ...", as a shell takes it; without --shard, --jobs and --out.
  std::string compare;  ///< A campaign to compare the whole with, "" for none.
};

/// Writes the scripts and submits them; answers what was submitted, one line.
/// @throws std::runtime_error where there is no sbatch, it refuses, or OUT.slurm is another's.
std::string submit_to_slurm(const SlurmCampaign& campaign);

/// The shards of OUT.slurm that lack a run, from 1. @throws std::runtime_error when there is no such campaign.
[[nodiscard]] std::vector<std::uint64_t> unfinished_shards(const std::filesystem::path& out);

/// Submits the array again for these shards alone, and the merge after it; answers what was submitted, one line.
std::string resume_on_slurm(const std::filesystem::path& out,
                            const std::vector<std::uint64_t>& shards);

/// The folders of all shards of OUT.slurm.
[[nodiscard]] std::vector<std::filesystem::path> shard_folders(const std::filesystem::path& out);

}  // namespace gatefly::cli
