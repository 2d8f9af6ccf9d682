// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/report/list_page.hpp"
#include "gatefly/report/page.hpp"
#include "gatefly/sim/camera.hpp"
#include "gatefly/simulated_race/results/campaign_comparison.hpp"

#include "campaign_fleet.hpp"
#include "campaign_folder.hpp"
#include "campaign_report.hpp"
#include "campaign_slurm.hpp"
#include "commands.hpp"
#include "fault_suite.hpp"
#include "race_options.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

struct CampaignOptions {
  RaceOptions race;
  int runs = 0, jobs = 0;
  std::optional<std::uint64_t> first_seed;
  int slurm = 0;
  std::string shard, out, resume;
  std::vector<std::string> merge, compare, only;
  bool json = false, faults = false;
};

constexpr std::uint64_t kMostParts = 1'000'000;  // as --runs

Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  Shard shard;
  char slash = '\0', rest = '\0';
  std::istringstream stream(text);
  if (!(stream >> shard.index >> slash >> shard.count) || slash != '/' || stream >> rest ||
      shard.index < 1 || shard.index > shard.count || shard.count > kMostParts ||
      text.find('-') != std::string::npos)
    throw std::runtime_error("--shard " + text + ": must be i/n with 1 <= i <= n <= " +
                             std::to_string(kMostParts) + ", e.g. 2/5");
  return shard;
}

/// Flies seeds on several threads and keeps each summary in a file of its own.
class Fleet {
 public:
  Fleet(const simulated_race::RaceMaker& maker, CampaignFolder& folder,
        std::vector<std::uint64_t> seeds)
      : maker_{maker}, folder_{folder}, seeds_{std::move(seeds)} {}

  /// @throws whatever a worker threw. Returns early, or throws Interrupted, after Ctrl-C: what has
  ///     finished is kept.
  void fly(int jobs, bool quiet) {
    if (seeds_.empty()) return;
    // Data that all races share is made once, before several races would make it at the same time.
    const simulated_race::Race first = maker_.race(seeds_.front());
    if (first.config.vision == simulated_race::Vision::kRendered) {
      const world::SimConfig& s = first.config.sim;
      const sim::CameraRenderer bakes{
          s.world, s.camera, s.light, s.seed, s.cache_dir, s.bake_threads, stop_if_interrupted};
    }
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> workers;
    running_ = std::clamp(jobs, 1, static_cast<int>(seeds_.size()));
    for (int i = running_; i > 0; --i) workers.emplace_back([this] { work(); });
    Progress progress(quiet, 10.0);
    {
      std::unique_lock lock{mutex_};
      while (running_ > 0) {
        changed_.wait_for(lock, std::chrono::milliseconds{200});
        const double elapsed =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (progress.due(elapsed)) progress.update(part(), text());
      }
    }
    for (std::thread& worker : workers) worker.join();
    progress.clear();
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void work() {
    try {
      for (std::size_t i = next_++; i < seeds_.size() && !stop_ && !interrupted(); i = next_++) {
        simulated_race::Race race = maker_.race(seeds_[i]);
        race.config.sim.bake_threads = 1;
        race.config.while_baking = [this] {
          if (stop_ || interrupted()) throw Interrupted{};
        };
        const auto result = simulated_race::fly(
            race.config, [this](const flight_log::Tick&) { return !stop_ && !interrupted(); });
        if (stop_ || interrupted()) break;
        folder_.keep(seeds_[i], files::json_text(simulated_race::summary(result, race.identity)));
        const std::lock_guard lock{mutex_};
        ++done_;
        finished_ += result.finished;
      }
    } catch (...) {
      const std::lock_guard lock{mutex_};
      if (!error_) error_ = std::current_exception();
      stop_ = true;
    }
    const std::lock_guard lock{mutex_};
    --running_;
    changed_.notify_one();
  }

  [[nodiscard]] double part() const {
    return static_cast<double>(done_) / static_cast<double>(seeds_.size());
  }
  [[nodiscard]] std::string text() const {
    return std::to_string(done_) + " of " + files::amount(seeds_.size(), "run") + ", " +
           std::to_string(finished_) + " finished";
  }

  const simulated_race::RaceMaker& maker_;
  CampaignFolder& folder_;
  std::vector<std::uint64_t> seeds_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  int running_ = 0;
  std::size_t done_ = 0, finished_ = 0;
  std::exception_ptr error_;
};

/// Two campaigns paired seed by seed. @throws std::runtime_error when they have nothing in common.
nlohmann::ordered_json compared(const CampaignFolder& first, const CampaignFolder& second) {
  const auto track = [](const CampaignFolder& folder) {
    return folder.arguments().value("track", "");
  };
  if (track(first) != track(second))
    throw std::runtime_error("--compare " + first.path().string() + ": is of " + track(first) +
                             ", " + second.path().string() + " of " + track(second));
  nlohmann::ordered_json json{{"first", first.path().string()}, {"second", second.path().string()}};
  json["differences"] = simulated_race::argument_differences(first.arguments(), second.arguments());
  json.update(simulated_race::campaign_comparison(first.rows(), second.rows()));
  if (json.at("pairs") == 0)
    throw std::runtime_error("--compare " + first.path().string() +
                             ": has no seed in common with " + second.path().string());
  return json;
}

/// The same as a page.
std::string page_of(nlohmann::ordered_json comparison, const CampaignFolder& first,
                    const CampaignFolder& second) {
  const auto a = first.rows(), b = second.rows();
  comparison["lost_by"] = {simulated_race::campaign_result(a).at("lost_by"),
                           simulated_race::campaign_result(b).at("lost_by")};
  comparison["seeds"] = simulated_race::campaign_pairs(a, b);
  const std::string title = first.arguments().value("track", "") + ", two campaigns, " +
                            files::amount(comparison.at("pairs").get<int>(), "seed") + " in common";
  return report::comparison_page(report::shipped_page("campaign.html"), title, comparison);
}

/// "before": a folder's own name, however it was given.
std::string name_of(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// Two campaigns that are there; flies nothing.
int compare(const CampaignOptions& options) {
  const CampaignFolder first = CampaignFolder::existing(options.compare[0]),
                       second = CampaignFolder::existing(options.compare[1]);
  const fs::path out =
      options.out.empty()
          ? fs::path{"out"} / ("compare-" + name_of(first.path()) + "-" + name_of(second.path()))
          : fs::path{options.out};
  const auto json = compared(first, second);
  files::check_output_folder("--out", out);
  files::refuse_foreign_folder(out, "comparison.json", {"comparison", "mcnemar_p", 1 << 20},
                               "choose another --out");
  catch_interrupt();  // both files or none: it takes no time
  fs::create_directories(out);
  files::write_files(
      std::vector<files::FileContent>{{out / "comparison.json", files::json_text(json)},
                                      {out / "report.html", page_of(json, first, second)}});
  if (options.json) {
    std::cout << files::json_text(json);
  } else {
    print_comparison(json);
    std::cout << "  page            " << (out / "report.html").string() << '\n';
  }
  return kDone;
}

/// Statistics of all runs of a whole folder; prints and writes them.
void conclude(CampaignFolder& folder, const std::vector<std::uint64_t>& seeds,
              const CampaignOptions& options) {
  std::vector<simulated_race::RunRow> rows;
  for (const std::uint64_t seed : seeds) rows.push_back(folder.row(seed).value());
  nlohmann::ordered_json campaign = folder.finish(rows);
  if (!options.compare.empty()) {
    const CampaignFolder other = CampaignFolder::existing(options.compare[0]);
    campaign["comparison"] = compared(other, folder);
    files::write_file(folder.path() / "comparison.html",
                      page_of(campaign["comparison"], other, folder));
  }
  if (options.json)
    std::cout << files::json_text(campaign);
  else
    print_campaign(campaign, folder.path(), options.race.common.quiet);
  if (!options.compare.empty() && !options.json) print_comparison(campaign.at("comparison"));
}

int merge(const CampaignOptions& options) {
  if (options.out.empty()) throw std::runtime_error("--merge: needs an --out for the whole");
  CampaignFolder whole = merged(options.out, {options.merge.begin(), options.merge.end()});
  conclude(whole, whole.seeds(), options);
  return kDone;
}

/// Submits what is missing of a campaign on Slurm, or concludes it when nothing is.
int resume(CampaignOptions options) {
  const auto shards = unfinished_shards(options.resume);
  if (!shards.empty()) {
    std::cout << resume_on_slurm(options.resume, shards) << '\n';
    return kDone;
  }
  for (const fs::path& shard : shard_folders(options.resume))
    options.merge.push_back(shard.string());
  options.out = options.resume;
  return merge(options);
}

/// Hands the whole campaign to Slurm.
int submit(const CampaignOptions& options, const fs::path& out) {
  if (!options.shard.empty()) throw std::runtime_error("--slurm: makes the shards, no --shard");
  if (options.slurm > options.runs)
    throw std::runtime_error("--slurm " + std::to_string(options.slurm) +
                             ": more shards than the " + files::amount(options.runs, "run"));
  const auto number = [](auto value) { return std::to_string(value); };
  std::cout << submit_to_slurm({.out = out,
                                .runs = static_cast<std::uint64_t>(options.runs),
                                .shards = static_cast<std::uint64_t>(options.slurm),
                                .jobs = std::max(1, options.jobs),
                                .name = "gatefly-" + fs::path{options.race.track}.stem().string(),
                                .words = "campaign " + shell_quoted(options.race.track) +
                                         " --runs " + number(options.runs) + " --first-seed " +
                                         number(options.first_seed.value_or(1)) +
                                         race_flags(options.race),
                                .compare = options.compare.empty() ? "" : options.compare[0]})
            << '\n';
  return kDone;
}

int campaign(const CampaignOptions& options) {
  if (options.compare.size() > 2)
    throw std::runtime_error("--compare: one campaign to compare with, or two that are there");
  if (options.compare.size() == 2) return compare(options);
  if (!options.compare.empty()) (void)CampaignFolder::existing(options.compare[0]).rows();
  if (!options.merge.empty()) return merge(options);
  if (!options.resume.empty()) return resume(options);
  const Shard shard = shard_of(options.shard);
  if (options.runs < 1) throw std::runtime_error("--runs: how many? (a whole number, 1 or more)");
  const SeedRange range{.first = options.first_seed.value_or(1),
                        .runs = static_cast<std::uint64_t>(options.runs),
                        .shard = shard};
  expect_seeds(range);
  const simulated_race::RaceMaker maker = race_maker(options.race);
  (void)maker.race(range.first);
  std::string name = "campaign-" + fs::path{options.race.track}.stem().string();
  if (options.race.vision != "rendered") name += "-" + options.race.vision;
  if (shard.count > 1)
    name += "-" + std::to_string(shard.index) + "of" + std::to_string(shard.count);
  const fs::path out = options.out.empty() ? fs::path{"out"} / name : fs::path{options.out};
  if (options.slurm > 0) return submit(options, out);
  CampaignFolder folder = flown(maker, options.race, range, out, options.jobs);
  const std::vector<std::uint64_t> seeds = folder.seeds();
  if (interrupted()) {
    const auto there =
        std::count_if(seeds.begin(), seeds.end(), [&](auto seed) { return folder.has(seed); });
    std::cerr << "gatefly campaign: interrupted, " << there << " of " << seeds.size()
              << " runs kept in " << folder.path().string()
              << "; the same command flies the rest\n";
    return kInterrupted;
  }
  conclude(folder, seeds, options);
  return kDone;
}

}  // namespace

void expect_seeds(const SeedRange& range) {
  if (range.first > std::numeric_limits<std::uint64_t>::max() - (range.runs - 1))
    throw std::runtime_error("--first-seed " + std::to_string(range.first) + ": " +
                             std::to_string(range.runs) + " runs from there on have no seeds");
}

CampaignFolder flown(const simulated_race::RaceMaker& maker, const RaceOptions& options,
                     const SeedRange& range, const fs::path& out, int jobs) {
  const simulated_race::Race race = maker.race(range.first);
  nlohmann::json arguments{{"track", race.identity.track},
                           {"track_toml", maker.inputs().at("track.toml")},
                           {"vision", race.identity.vision},
                           {"first_seed", range.first},
                           {"runs", range.runs},
                           {"shard", {range.shard.index, range.shard.count}},
                           {"version", race.identity.version},
                           {"commit", race.identity.commit},
                           {"config", race.identity.config}};
  if (const auto table = maker.inputs().find("colors.toml"); table != maker.inputs().end()) {
    arguments["color_table"] = table->second;  // its content counts, not where it lies
    arguments["config"]["color"].erase("table");
  }
  catch_interrupt();
  CampaignFolder folder = CampaignFolder::opened(out, arguments, fly_command(options, "{seed}"));

  const std::vector<std::uint64_t> seeds = folder.seeds();
  std::vector<std::uint64_t> left;
  for (const std::uint64_t seed : seeds)
    if (!folder.has(seed)) left.push_back(seed);
  if (!left.empty() && left.size() < seeds.size() && !options.common.quiet)
    std::cerr << "gatefly campaign: " << seeds.size() - left.size() << " of " << seeds.size()
              << " runs are there, " << left.size() << " to fly\n";
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  try {
    Fleet(maker, folder, left).fly(jobs > 0 ? jobs : cores, options.common.quiet);
  } catch (const Interrupted&) {  // what has finished is kept
  }
  return folder;
}

void declare_campaign(Command& command) {
  auto options = std::make_shared<CampaignOptions>();
  command.footer(
      "Example:\n  gatefly campaign oval --runs 40 --vision ideal\n"
      "  gatefly campaign showroom --runs 300 --shard 1/2 --out out/half-1\n"
      "  gatefly campaign --merge out/half-1 out/half-2 --out out/whole\n"
      "  gatefly campaign --compare out/before out/after\n"
      "  gatefly campaign showroom --runs 300 --slurm 8 --out out/big\n"
      "  gatefly campaign --faults --out out/faults\n\n"
      "Started again with the same arguments it flies only the seeds that are missing.\n"
      "Exit code 0: all were flown; 2: unusable arguments or track; 130: Ctrl-C, finished runs are "
      "kept.");
  options->race.track.clear();
  command.option("TRACK", options->race.track,
                 "a name in tracks/ or a file [showroom; with --faults: oval]");
  const Flag faults = command.flag(
      "--faults", options->faults,
      "every fault of docs/reliability.md in turn, each on --runs seeds [20] from --first-seed on "
      "[6001], at most 5 where pictures are rendered");
  command.option("--only", options->only, "of them, beside F0 (no fault), only these: F1,F2,...")
      .separated_by(',')
      .needs(faults);
  command.option("--runs", options->runs, "how many seeds").between(1, 1000000);
  command.option("--first-seed", options->first_seed, "and from which on [1]");
  command.option("--jobs", options->jobs, "races at the same time [one a core]").between(1, 1024);
  command
      .option("--shard", options->shard,
              "only every n-th seed, from the i-th on: for several machines")
      .type_name("i/n")
      .excludes(faults);
  command
      .option("--slurm", options->slurm,
              "instead of flying: submits so many shards to Slurm, and their merge after them")
      .between(1, static_cast<int>(kMostShards))
      .excludes(faults);
  command
      .option("--resume", options->resume,
              "instead of flying: submits what is missing of such a campaign, by its --out")
      .path("DIR")
      .excludes(faults);
  command.option("--merge", options->merge, "instead of flying: the shards' folders")
      .path("DIR")
      .excludes(faults);
  command
      .option("--compare", options->compare,
              "pair it seed by seed with another campaign; with two folders nothing is flown")
      .path("DIR")
      .excludes(faults);
  command.option("--out", options->out, "folder for the campaign [out/campaign-TRACK]").path("DIR");
  command.flag("--json", options->json, "print campaign.json instead of a screen").excludes(faults);
  add_race_options(command, options->race);
  command.runs([options] {
    take_drone(options->race.drone, options->race.common);
    if (options->race.track.empty()) options->race.track = options->faults ? "oval" : "showroom";
    if (!options->faults) return campaign(*options);
    return fault_suite({.race = options->race,
                        .runs = options->runs > 0 ? options->runs : 20,
                        .jobs = options->jobs,
                        .first_seed = options->first_seed.value_or(6001),
                        .out = options->out.empty() ? "out/faults" : options->out,
                        .only = options->only});
  });
}

}  // namespace gatefly::cli
