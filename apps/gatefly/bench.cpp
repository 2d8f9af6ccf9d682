// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>

#include "gatefly/experiments/bench/camera_stages.hpp"
#include "gatefly/experiments/bench/detection_stages.hpp"
#include "gatefly/experiments/bench/flight_stages.hpp"
#include "gatefly/experiments/bench/opencv_baseline.hpp"
#include "gatefly/experiments/bench/pose_stages.hpp"
#include "gatefly/experiments/bench/worst_picture.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"

#include "race_options.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using namespace bench;
using nlohmann::ordered_json;
using Pictures = std::shared_ptr<const std::vector<Picture>>;

struct BenchOptions {
  RaceOptions race;
  std::vector<std::string> stages, pictures;
  std::string data;
  bool quick = false, once = false, worst = false, json = false;
};

/// Sides from 160 to 1280; the scene is the same.
constexpr std::array kSizes{std::pair{160, 120}, std::pair{320, 240}, std::pair{640, 480},
                            std::pair{1280, 960}};
const std::vector<std::string> kScene{"gate:60:0.05:0", "gate:90:0.05:20", "gate:40:0.06:-10",
                                      "noise:9:0.02:0", "gates:110:0.06:5"};

std::vector<Stage> chosen(std::vector<Stage> stages, const std::vector<std::string>& names) {
  if (names.empty()) return stages;
  std::vector<std::string> known;
  for (const Stage& stage : stages) known.push_back(stage.name);
  for (const std::string& name : names)
    if (find(stages, name) == nullptr)
      throw std::runtime_error("--stage '" + files::one_line(name) + "' is not known" +
                               files::suggestion(name, known) +
                               " (there are: " + files::joined(known) + ")");
  std::erase_if(stages, [&](const Stage& s) {
    return std::find(names.begin(), names.end(), s.name) == names.end();
  });
  return stages;
}

Picture read(const fs::path& path, const config::Config& config) {
  const files::ImageFile file =
      files::read_image(path, config.camera.stored_width(), config.camera.stored_height());
  return as_uyvy(path.filename().string(), file.view(0), config.camera.stored_rotation_deg);
}

/// Files, folders and patterns, as named.
Pictures named_pictures(const BenchOptions& options, const config::Config& config) {
  auto pictures = std::make_shared<std::vector<Picture>>();
  for (const std::string& name : options.pictures) {
    const fs::path path = data_at(name, options.data);
    std::error_code error;
    if (fs::exists(path, error)) {
      for (const fs::path& file : files::picture_files(path))
        pictures->push_back(read(file, config));
    } else {
      pictures->push_back(drawn(pattern_of(name)));
    }
  }
  return pictures;
}

/// Some pictures of the authors', when they are there: every n-th of both halls.
Pictures real_pictures(const BenchOptions& options, const config::Config& config,
                       std::size_t most) {
  auto pictures = std::make_shared<std::vector<Picture>>();
  for (const char* set : {"basement580", "cyberzoo"}) {
    const fs::path folder = data_at(fs::path{"tudelft_bebop_gates"} / set, options.data);
    std::error_code error;
    if (!fs::is_directory(folder, error)) continue;
    const auto files = files::picture_files(folder);
    for (std::size_t i = 0; i < most / 2; ++i)
      pictures->push_back(read(files[i * files.size() / (most / 2)], config));
  }
  return pictures;
}

/// A table on the screen, and the same in JSON.
class Report {
 public:
  explicit Report(bool json) : json_{json} {}

  void stages(const std::string& title, const std::string& key, std::span<const Stage> stages,
              std::span<const Cost> costs) {
    heading(title, "stage", {"median us", "p99 us", "max us", "x baseline"});
    for (std::size_t i = 0; i < stages.size() && i < costs.size(); ++i) {
      const Stage* const baseline = find(stages, stages[i].baseline);
      const double base =
          baseline ? costs[static_cast<std::size_t>(baseline - stages.data())].median : 0.0;
      const double ratio = base > 0.0 ? costs[i].median / base : 0.0;
      row(stages[i].name, {costs[i].median, costs[i].p99, costs[i].most, ratio}, stages[i].what);
      ordered_json entry{{"name", stages[i].name},
                         {"what", stages[i].what},
                         {"median_us", costs[i].median},
                         {"p99_us", costs[i].p99},
                         {"max_us", costs[i].most}};
      if (base > 0.0) entry["baseline"] = stages[i].baseline, entry["times_baseline"] = ratio;
      all_[key].push_back(entry);
    }
  }
  /// The same costs beside the baseline's, picture by picture.
  void ratios_of(const std::string& key, std::span<const Stage> stages,
                 std::span<const Cost> costs) {
    if (std::none_of(stages.begin(), stages.end(),
                     [&](const Stage& s) { return find(stages, s.baseline) != nullptr; }))
      return;
    heading("  picture by picture, the least of all rounds, x baseline", "stage",
            {"median", "mean", "p99", "max", "median us", "mean us"});
    for (std::size_t i = 0; i < stages.size() && i < costs.size(); ++i) {
      if (costs[i].least.empty()) continue;
      std::vector<double> least = costs[i].least;
      const double mean =
          std::accumulate(least.begin(), least.end(), 0.0) / static_cast<double>(least.size());
      const auto middle = least.begin() + static_cast<std::ptrdiff_t>(least.size() / 2);
      std::nth_element(least.begin(), middle, least.end());
      const Stage* const baseline = find(stages, stages[i].baseline);
      const Ratios r =
          baseline ? ratios(costs[i], costs[static_cast<std::size_t>(baseline - stages.data())])
                   : Ratios{};
      row(stages[i].name, {r.median, r.mean, r.p99, r.most, *middle, mean}, "");
      ordered_json& entry = all_[key][i];
      entry["least_us"] = {{"median", *middle}, {"mean", mean}};
      if (baseline)
        entry["times_baseline_each"] = {
            {"median", r.median}, {"mean", r.mean}, {"p99", r.p99}, {"max", r.most}};
    }
  }
  void heading(const std::string& title, const std::string& first,
               const std::vector<std::string>& columns) {
    if (json_) return;
    std::cout << title << "\n  " << std::left << std::setw(12) << first << std::right;
    for (const auto& column : columns) std::cout << std::setw(12) << column;
    std::cout << '\n';
  }
  void row(const std::string& name, const std::vector<double>& numbers, const std::string& what) {
    if (json_) return;
    std::cout << "  " << std::left << std::setw(12) << name << std::right << std::fixed;
    for (const double number : numbers) {
      if (number == 0.0)
        std::cout << std::setw(12) << "";
      else
        std::cout << std::setw(12) << std::setprecision(number < 10.0 ? 3 : 1) << number;
    }
    std::cout << "  " << what << '\n';
  }
  void note(const std::string& text) {
    if (!json_) std::cout << text << '\n';
    all_["notes"].push_back(text);
  }
  [[nodiscard]] ordered_json& json() { return all_; }
  ~Report() {
    if (json_ && !interrupted()) std::cout << files::json_text(all_);
  }
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

 private:
  bool json_;
  ordered_json all_ = ordered_json::object();
};

/// Slope of log(cost) over log(side): 1 grows with the side, 2 with the area.
double exponent(const std::vector<double>& medians) {
  double xx = 0, xy = 0, mx = 0, my = 0;
  const auto n = static_cast<double>(medians.size());
  for (std::size_t i = 0; i < medians.size(); ++i)
    mx += std::log(kSizes[i].first) / n, my += std::log(medians[i]) / n;
  for (std::size_t i = 0; i < medians.size(); ++i) {
    const double x = std::log(kSizes[i].first) - mx;
    xx += x * x, xy += x * (std::log(medians[i]) - my);
  }
  return xy / xx;
}

void report_sizes(const BenchOptions& options, const PilotConfig& config, int rounds,
                  Report& report) {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> medians;
  std::vector<Stage> stages;
  for (const auto& [width, height] : kSizes) {
    auto pictures = std::make_shared<std::vector<Picture>>();
    for (const std::string& scene : kScene)
      pictures->push_back(drawn(pattern_of(scene), width, height));
    stages = chosen(detection_stages(pictures, config), options.stages);
    const auto costs = measure(stages, rounds, interrupted);
    medians.resize(stages.size());
    for (std::size_t s = 0; s < stages.size(); ++s) medians[s].push_back(costs[s].median);
    columns.push_back(std::to_string(width) + "x" + std::to_string(height));
  }
  if (interrupted()) return;
  columns.push_back("exponent");
  report.heading("\nthe same scenes in other sizes, median us; cost ~ side^exponent", "stage",
                 columns);
  for (std::size_t s = 0; s < stages.size(); ++s) {
    std::vector<double> numbers = medians[s];
    numbers.push_back(exponent(medians[s]));
    report.row(stages[s].name, numbers, "");
    report.json()["sizes"].push_back(
        {{"name", stages[s].name}, {"median_us", medians[s]}, {"exponent", numbers.back()}});
  }
}

void report_worst(const BenchOptions& options, const PilotConfig& config, const Pictures& usual,
                  Report& report, Progress& progress) {
  const int tries = options.quick ? 8 : 60;
  report.heading("\nthe slowest picture that a search finds, least of 3 calls", "stage",
                 {"usual us", "worst us", "x usual"});
  const auto stages = chosen(detection_stages(usual, config), options.stages);
  for (std::size_t s = 0; s < stages.size() && !interrupted(); ++s) {
    if (progress.due(static_cast<double>(s)))
      progress.update(static_cast<double>(s) / static_cast<double>(stages.size()),
                      "worst picture: " + stages[s].name);
    std::vector<double> times;
    for (std::size_t i = 0; i < usual->size(); ++i)
      times.push_back(least_time([&] { stages[s].call(i); }, 3));
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                     times.end());
    const double median = times[times.size() / 2];
    // The same stage on one picture that changes.
    auto slot = std::make_shared<std::vector<Picture>>(1);
    const auto of_slot = detection_stages(slot, config);
    const Stage& stage = *find(of_slot, stages[s].name);
    Rng rng{1};
    const WorstPicture worst =
        worst_picture([&](const Picture& picture) { slot->front() = picture, stage.call(0); },
                      tries, rng, interrupted);
    progress.clear();
    report.row(stage.name, {median, worst.time_us, worst.time_us / median}, worst.pattern.name());
    report.json()["worst"].push_back({{"name", stage.name},
                                      {"usual_us", median},
                                      {"worst_us", worst.time_us},
                                      {"times_usual", worst.time_us / median},
                                      {"picture", worst.pattern.name()}});
  }
}

/// Every input once, names on stdout: what tools/count_instructions.py runs.
int run_once(const BenchOptions& options, const Pictures& pictures, const PilotConfig& config) {
  if (options.stages.size() != 1) throw std::runtime_error("--once: name one --stage");
  if (pictures->empty()) throw std::runtime_error("--once: name --pictures");
  const auto stages = chosen(detection_stages(pictures, config), options.stages);
  stages.front().call(0);  // not counted: tables and buffers are made
  for (std::size_t i = 0; i < pictures->size(); ++i) {
    call(stages.front(), i);
    std::cout << (*pictures)[i].name << '\n';
  }
  return kDone;
}

/// gatefly bench: exit 0 measured, 2 unusable arguments, 130 Ctrl-C.
int bench_all(const BenchOptions& options) {
  const config::Config config = load(options.race.common);
  const int rounds = options.quick ? 3 : 15;
  catch_interrupt();
  const Pictures named = named_pictures(options, config);
  if (options.once) return run_once(options, named, config.pilot);
  if (!options.stages.empty()) (void)chosen(detection_stages(named, config.pilot), options.stages);

  Progress progress(options.race.common.quiet, 1.0);
  const auto say = [&](double part, const std::string& text) {
    if (progress.due(10.0 * part)) progress.update(part, text);
  };
  Report report(options.json);
  if (!has_opencv())
    report.note("OpenCV was not there when this was built: its baselines are left out");

  Pictures usual = named;
  if (!named->empty()) {
    const auto stages = chosen(detection_stages(named, config.pilot), options.stages);
    const auto costs = measure(stages, rounds, interrupted);
    report.stages("detection, " + files::amount(named->size(), "picture"), "detection", stages,
                  costs);
    report.ratios_of("detection", stages, costs);
  } else {
    say(0.0, "flying, for pictures");
    simulated_race::Race race = race_maker(options.race).race(1);
    race.config.while_baking = stop_if_interrupted;
    const auto flight = std::make_shared<const RecordedFlight>(
        recorded_flight(race.config, options.quick ? 20 : 60, interrupted));
    if (interrupted()) return kInterrupted;
    usual = std::make_shared<const std::vector<Picture>>(flight->pictures);
    say(0.2, "detection");
    const auto on_rendered = chosen(detection_stages(usual, race.config.pilot), options.stages);
    const auto rendered = measure(on_rendered, rounds, interrupted);
    say(0.5, "real pictures");
    const Pictures real = real_pictures(options, config, options.quick ? 8 : 40);
    const auto on_real = chosen(detection_stages(real, config.pilot), options.stages);
    const auto costs_real = measure(on_real, rounds, interrupted);
    progress.clear();
    if (interrupted()) return kInterrupted;
    report.stages("detection, " + std::to_string(usual->size()) + " rendered pictures of " +
                      race.identity.track,
                  "rendered", on_rendered, rendered);
    if (real->empty()) {
      report.note("real pictures: none there (--data DIR)");
    } else {
      report.stages("\ndetection, " + std::to_string(real->size()) + " real pictures", "real",
                    on_real, costs_real);
      report.ratios_of("real", on_real, costs_real);
    }
    if (options.stages.empty()) {
      const auto stages = flight_stages(flight, race.config.pilot);
      report.stages("\nwhat follows", "flight", stages, measure(stages, rounds, interrupted));
      const auto poses = pose_stages();
      report.stages("\npose from four corners, 500 gates", "pose", poses,
                    measure(poses, rounds, interrupted));
      const auto frames = camera_stages(race.config.sim, stop_if_interrupted);
      report.stages("\nthe simulated camera, before each gate", "camera", frames,
                    measure(frames, rounds, interrupted));
      report.heading("\nwhole steps, in that flight", "stage", {"median us", "p99 us", "max us"});
      for (const auto& t : flight->timings) {
        report.row(t.stage, {t.p50_us, t.p99_us, t.max_us}, "");
        report.json()["steps"].push_back({{"name", t.stage},
                                          {"median_us", t.p50_us},
                                          {"p99_us", t.p99_us},
                                          {"max_us", t.max_us}});
      }
    }
    report_sizes(options, config.pilot, options.quick ? 2 : 9, report);
  }
  if (options.worst) report_worst(options, config.pilot, usual, report, progress);
  if (interrupted()) {
    std::cerr << "gatefly bench: interrupted\n";
    return kInterrupted;
  }
  return kDone;
}

}  // namespace

void declare_bench(Command& command) {
  auto options = std::make_shared<BenchOptions>();
  options->race.track = "oval";
  command.footer(
      "Example:\n  gatefly bench --quick\n  gatefly bench --stage careful --worst\n"
      "  gatefly bench --pictures ../shared/data/tudelft_bebop_gates/cyberzoo checker:8:0.5\n\n"
      "Pictures come from the beginning of a simulated race, and from the authors' sets when they "
      "are there. One core;\n"
      "all stages take turns on a picture, so that ratios mean more than times; picture by picture "
      "they are those of the\nleast time of all rounds. --pictures also "
      "takes patterns (gate,\n"
      "all, checker, noise, spiral, rings, stripes, comb, gates) with up to three numbers. "
      "Instructions instead of time:\n"
      "tools/count_instructions.py. Exit code 0: measured; 2: unusable arguments; 130: Ctrl-C.");
  command.option("--stage", options->stages, "only these detectors").type_name("NAME");
  command
      .option("--pictures", options->pictures,
              "files, folders or patterns instead of the race's and the real ones")
      .type_name("PATH");
  command.flag("--worst", options->worst, "also search for the slowest picture of each detector");
  command.flag("--once", options->once, "one call a picture, nothing measured: for callgrind");
  command.flag("--quick", options->quick, "fewer pictures and rounds: seconds");
  command.option("--data", options->data, "folder of real data [$GATEFLY_DATA, ../shared/data]")
      .path("DIR");
  command.flag("--json", options->json, "print JSON");
  add_common(command, options->race.common);
  command.runs([options] { return bench_all(*options); });
}

}  // namespace gatefly::cli
