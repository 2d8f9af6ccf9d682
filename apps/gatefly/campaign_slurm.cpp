// SPDX-License-Identifier: Apache-2.0
#include "campaign_slurm.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <unistd.h>

#include "gatefly/files/json_file.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/subprocess.hpp"
#include "gatefly/files/text.hpp"

#include "campaign_folder.hpp"
#include "race_options.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& out) {
  // "out/big/" is "out/big".
  const fs::path plain = out.filename().empty() ? out.parent_path() : out;
  return fs::absolute(plain).lexically_normal().concat(".slurm");
}

fs::path shard_folder(const fs::path& folder, std::uint64_t index, std::uint64_t count) {
  return folder / (std::to_string(index) + "of" + std::to_string(count));
}

std::string program() { return sibling(kProgram).string(); }

/// The array job: Slurm gives each task its number.
std::string shards_script(const SlurmCampaign& campaign, const fs::path& folder) {
  const std::string n = std::to_string(campaign.shards);
  return "#!/bin/bash\n# Flies one shard of a campaign; by hand: SLURM_ARRAY_TASK_ID=1 bash "
         "shards.sh\n#SBATCH --job-name=" +
         campaign.name + "\n#SBATCH --array=1-" + n +
         "\n#SBATCH --cpus-per-task=" + std::to_string(campaign.jobs) +
         "\n#SBATCH --open-mode=append\nshard=\"${SLURM_ARRAY_TASK_ID:?which shard, 1 to " + n +
         "}\"\nexec " + shell_quoted(program()) + " " + campaign.words + " --quiet --jobs " +
         std::to_string(campaign.jobs) + " --shard \"$shard/" + n + "\" --out " +
         shell_quoted(folder.string()) + "/\"${shard}of" + n + "\"\n";
}

std::string merge_script(const SlurmCampaign& campaign, const fs::path& folder) {
  std::string text =
      "#!/bin/bash\n# Makes one campaign of the shards; says which run is missing, if one "
      "is.\n#SBATCH --job-name=" +
      campaign.name + "-merge\n#SBATCH --open-mode=append\nexec " + shell_quoted(program()) +
      " campaign --quiet --merge";
  for (std::uint64_t i = 1; i <= campaign.shards; ++i)
    text += " " + shell_quoted(shard_folder(folder, i, campaign.shards).string());
  if (!campaign.compare.empty())
    text += " --compare " + shell_quoted(fs::absolute(campaign.compare).string());
  return text + " --out " + shell_quoted(fs::absolute(campaign.out).string()) + "\n";
}

/// Runs sbatch and answers the last line it prints. @throws std::runtime_error with its last line.
std::string sbatch(std::vector<std::string> words) {
  words.insert(words.begin(), "sbatch");
  using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;
  const File output{std::tmpfile(), &std::fclose}, errors{std::tmpfile(), &std::fclose};
  if (!output || !errors) throw std::runtime_error("sbatch: no room for a temporary file");
  pid_t pid = 0;
  const int failed = files::start(words, {-1, fileno(output.get()), fileno(errors.get())}, pid);
  if (failed != 0)
    throw std::runtime_error(std::string{"sbatch: "} + std::strerror(failed) +
                             " (Slurm submits by it; Debian's package is slurm-client)");
  if (files::wait_for(pid) != 0)
    throw std::runtime_error("sbatch: " + files::last_line(errors.get()));
  std::rewind(output.get());
  return files::last_line(output.get());
}

/// Submits the shards, then the merge that waits for them, whether they went well or not: it names what is missing.
std::string submit(const fs::path& folder, const std::string& array, const std::string& what) {
  const std::string where = "--chdir=" + fs::current_path().string();
  const auto log = [&](const char* name) { return "--output=" + (folder / name).string(); };
  // "12;cluster": of several clusters it names its own.
  const auto job = [](const std::string& said) { return said.substr(0, said.find(';')); };
  const std::string flown = job(sbatch({"--parsable", "--array=" + array, where,
                                        log("shard-%a.log"), (folder / "shards.sh").string()}));
  const std::string merged = job(sbatch({"--parsable", "--dependency=afterany:" + flown, where,
                                         log("merge.log"), (folder / "merge.sh").string()}));
  return what + " as job " + flown + ", merged by job " + merged + "; logs in " + folder.string();
}

std::uint64_t shards_of(const fs::path& out) {
  const fs::path file = folder_of(out) / "slurm.json";
  const auto json = files::read_json(file);
  return files::JsonObject(file.string(), json).whole("shards", 1, kMostShards);
}

}  // namespace

std::string submit_to_slurm(const SlurmCampaign& campaign) {
  const fs::path folder = folder_of(campaign.out);
  (void)sbatch({"--version"});  // before anything is written
  files::check_output_folder("--out", folder);
  if (fs::exists(folder))
    throw std::runtime_error(folder.string() + ": is there from another submission; --resume " +
                             campaign.out.string() + " goes on with it, or choose another --out");
  fs::create_directories(folder);
  const nlohmann::json json{{"shards", campaign.shards}, {"runs", campaign.runs}};
  files::write_file(folder / "shards.sh", shards_script(campaign, folder));
  files::write_file(folder / "merge.sh", merge_script(campaign, folder));
  files::write_file(folder / "slurm.json", json.dump(2) + "\n");
  const std::string n = std::to_string(campaign.shards);
  return submit(folder, "1-" + n, n + " shards of " + files::amount(campaign.runs, "run"));
}

std::vector<std::uint64_t> unfinished_shards(const fs::path& out) {
  const std::uint64_t count = shards_of(out);
  std::vector<std::uint64_t> unfinished;
  for (std::uint64_t i = 1; i <= count; ++i) {
    const fs::path folder = shard_folder(folder_of(out), i, count);
    const auto is_whole = [&] {
      const CampaignFolder shard = CampaignFolder::existing(folder);
      return shard.rows().size() == shard.seeds().size();
    };
    if (!fs::exists(folder / "campaign.json") || !is_whole()) unfinished.push_back(i);
  }
  return unfinished;
}

std::string resume_on_slurm(const fs::path& out, const std::vector<std::uint64_t>& shards) {
  std::vector<std::string> numbers;
  for (const std::uint64_t shard : shards) numbers.push_back(std::to_string(shard));
  return submit(folder_of(out), files::joined(numbers, ","),
                std::to_string(shards.size()) + " of " + files::amount(shards_of(out), "shard"));
}

std::vector<fs::path> shard_folders(const fs::path& out) {
  std::vector<fs::path> folders;
  const std::uint64_t count = shards_of(out);
  for (std::uint64_t i = 1; i <= count; ++i)
    folders.push_back(shard_folder(folder_of(out), i, count));
  return folders;
}

}  // namespace gatefly::cli
