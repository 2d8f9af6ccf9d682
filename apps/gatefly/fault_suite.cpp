// SPDX-License-Identifier: Apache-2.0
#include "fault_suite.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>

#include "gatefly/files/json_file.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"

#include "campaign_fleet.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kAt = 8.0;       // when a fault with a time begins [s]: in the oval's second lap
constexpr int kMostRendered = 5;  // runs of a row with pictures, each as long as ten without
constexpr double kAnything = std::numeric_limits<double>::infinity();

/// What a row asks for. Errors are root mean squares of a race's estimate [m].
struct PassRule {
  std::string text;
  double finished = 0.0;            ///< At least this part of the runs.
  bool others_land = false;         ///< And the others land, without touching anything before.
  double most_seconds = kAnything;  ///< From the fault to the end of the flight.
  double most_height_error = kAnything, most_side_error = kAnything;
  double most_error_ratio = kAnything;  ///< The median run's error, of that without a fault.
};

PassRule finish() { return {.text = "all finish", .finished = 1.0}; }
PassRule finish_or_safe() { return {.text = "finish or land", .others_land = true}; }

/// One level of one fault.
struct FaultRow {
  std::string fault, injected;
  std::vector<std::string> settings;  ///< As --set takes them; none: nothing breaks.
  PassRule rule;
  bool rendered = false;
  std::string not_injected = "";  ///< Why; such a row is not flown.
};

FaultRow left_out(const char* fault, const char* what, const char* why) {
  return {.fault = fault, .injected = what, .settings = {}, .rule = {}, .not_injected = why};
}

/// The fault list, F0 to F20, at the levels that it names.
std::vector<FaultRow> fault_rows() {
  const PassRule fast_and_safe{
      .text = "land within 3 s (drift is not measured)", .others_land = true, .most_seconds = 3.0};
  PassRule compensated = finish();
  compensated.text = "all finish, error below twice F0's";
  compensated.most_error_ratio = 2.0;
  PassRule level = finish();
  level.text = "all finish, error of height below 0.3 m";
  level.most_height_error = 0.3;
  PassRule aside = finish();
  aside.text = "all finish, error to the side below 0.3 m";
  aside.most_side_error = 0.3;
  const PassRule lands{.text = "land", .others_land = true};
  return {
      {"F0", "nothing", {}, finish()},
      {"F1", "10 % of the pictures lost", {"faults.camera_drop_percent=10"}, finish()},
      {"F1", "30 %", {"faults.camera_drop_percent=30"}, finish()},
      {"F1", "50 %", {"faults.camera_drop_percent=50"}, {.text = "90 % finish", .finished = 0.9}},
      {"F2", "no picture for 0.5 s", {"faults.camera_out_s=[8,0.5]"}, finish()},
      {"F2", "for 1 s", {"faults.camera_out_s=[8,1]"}, finish()},
      {"F2", "for 2 s", {"faults.camera_out_s=[8,2]"}, finish_or_safe()},
      {"F3",
       "the same picture for 1 s",
       {"faults.camera_stuck_s=[8,1]"},
       {.text = "finish or land (whether one was fused, a summary does not say)",
        .others_land = true},
       true},
      {"F4", "camera dead", {"faults.camera_out_s=[8,1000]"}, fast_and_safe},
      {"F5",
       "pictures 20 ms later than the pilot knows",
       {"faults.camera_delay_ms=20"},
       compensated},
      {"F5", "50 ms", {"faults.camera_delay_ms=50"}, compensated},
      {"F5", "100 ms", {"faults.camera_delay_ms=100"}, compensated},
      {"F5", "200 ms", {"faults.camera_delay_ms=200"}, finish_or_safe()},
      {"F5", "jitter of 30 ms", {"randomize.latency_jitter_ms=30"}, finish()},
      {"F6", "clock jumps by 0.1 s", {"faults.time_jump_s=[8,0.1]"}, finish_or_safe()},
      {"F6", "by -0.1 s", {"faults.time_jump_s=[8,-0.1]"}, finish_or_safe()},
      {"F6", "by 10 s", {"faults.time_jump_s=[8,10]"}, finish_or_safe()},
      {"F6", "by -10 s", {"faults.time_jump_s=[8,-10]"}, finish_or_safe()},
      left_out("F6", "stamps twice; wrap", "no key; `ctest -R c_interface` and `tests/sensing`"),
      {"F7", "one IMU sample not a number", {"faults.imu_nan_s=[8,0.0019]"}, finish()},
      {"F7", "for 50 ms", {"faults.imu_nan_s=[8,0.05]"}, finish_or_safe()},
      {"F7", "for ever", {"faults.imu_nan_s=[8,1000]"}, lands},
      {"F8", "IMU stuck", {"faults.imu_stuck_s=[8,1000]"}, lands},
      {"F9",
       "IMU saturates at 4 g, 500 °/s",
       {"faults.accel_range_mps2=39.2", "faults.gyro_range_degps=500"},
       finish_or_safe()},
      {"F10",
       "biases step by 1 °/s, 0.3 m/s²",
       {"faults.bias_step_at_s=8", "faults.gyro_bias_step_degps=[1,0,0]",
        "faults.accel_bias_step_mps2=[0.3,0,0]"},
       finish()},
      {"F10",
       "by 5 °/s, 1 m/s²",
       {"faults.bias_step_at_s=8", "faults.gyro_bias_step_degps=[5,0,0]",
        "faults.accel_bias_step_mps2=[1,0,0]"},
       finish_or_safe()},
      {"F11", "IMU mounted 3° rolled", {"faults.imu_tilt_deg=[3,0]"}, aside},
      {"F11", "5°", {"faults.imu_tilt_deg=[5,0]"}, finish_or_safe()},
      {"F11", "10°", {"faults.imu_tilt_deg=[10,0]"}, finish_or_safe()},
      {"F12",
       "a gate 0.3 m aside of the map",
       {"faults.moved_gate=-1", "faults.gate_aside_m=0.3"},
       finish()},
      {"F12", "0.5 m", {"faults.moved_gate=-1", "faults.gate_aside_m=0.5"}, finish()},
      {"F12", "1 m", {"faults.moved_gate=-1", "faults.gate_aside_m=1"}, finish_or_safe()},
      {"F12",
       "turned by 20°",
       {"faults.moved_gate=-1", "faults.gate_turned_deg=20"},
       finish_or_safe()},
      {"F13", "gate 2 is not there", {"faults.missing_gate=2"}, lands},
      {"F14", "2 false gates", {"faults.false_gates=2"}, finish_or_safe(), true},
      {"F14", "5 things of the gates' colour", {"randomize.decoys=5"}, finish_or_safe(), true},
      {"F14", "3 people", {"randomize.people=3"}, finish_or_safe(), true},
      left_out("F14", "reflection", "no key"),
      left_out("F15", "gates in line", "not on the oval; `grandprix` and `aigp-pq` have them"),
      {"F16", "lamps at 2 % for 1 s", {"faults.light_out_s=[8,1]"}, finish_or_safe(), true},
      {"F16", "noise 3 times as large", {"randomize.noise_scale=3"}, finish_or_safe(), true},
      {"F16",
       "white balance, σ 15 %",
       {"randomize.white_balance_percent=15"},
       finish_or_safe(),
       true},
      {"F16", "exposure, σ 40 %", {"randomize.exposure_percent=40"}, finish_or_safe(), true},
      left_out("F16", "flicker, dirt on the lens, blur of 10 px", "no key"),
      {"F17", "gates' hue 15° off the table", {"faults.hue_deg=15"}, finish_or_safe(), true},
      {"F18",
       "10 % of the thrust lost",
       {"faults.thrust_loss_percent=10", "faults.thrust_loss_s=[8,1000]"},
       finish()},
      {"F18", "20 %", {"faults.thrust_loss_percent=20", "faults.thrust_loss_s=[8,1000]"}, finish()},
      {"F18",
       "30 %",
       {"faults.thrust_loss_percent=30", "faults.thrust_loss_s=[8,1000]"},
       finish_or_safe()},
      {"F18",
       "one motor dead",
       {"faults.thrust_loss_percent=100", "faults.weak_rotor=1", "faults.thrust_loss_s=[8,1000]"},
       {.text = "cut or land", .others_land = true}},
      {"F19", "20 % of the thrust lost to the battery", {"faults.battery_sag_percent=20"}, level},
      {"F20", "wind of 0.5 m/s", {"faults.wind_mps=[0.5,0]"}, finish()},
      {"F20", "2 m/s", {"faults.wind_mps=[2,0]"}, finish_or_safe()},
      {"F20",
       "3 m/s for 0.5 s",
       {"faults.wind_mps=[3,0]", "faults.wind_s=[8,0.5]"},
       finish_or_safe()},
      {"F20", "gusts of 0.5 m/s", {"randomize.gust_mps=0.5"}, finish_or_safe()},
      left_out("F20", "ground effect", "no key"),
  };
}

/// What became of a row's runs.
struct FaultOutcome {
  int runs = 0, finished = 0, landed = 0, crashed = 0;
  double error = 0.0, height_error = 0.0, side_error = 0.0;  // median; worst, worst [m]
  double seconds = 0.0;                                      // worst, after the fault
  bool finite = true;
  std::string first_lost;
};

FaultOutcome outcome_of(const CampaignFolder& folder) {
  FaultOutcome outcome;
  std::vector<double> errors;
  for (const std::uint64_t seed : folder.seeds()) {
    const simulated_race::RunRow row = folder.row(seed).value();
    const nlohmann::ordered_json summary = files::read_json(folder.file_of(seed).string());
    const bool crashed = !summary.at("crash").is_null();
    // On the floor at the end of its landing: the race is over with the first touch.
    const bool landed = !row.finished && !crashed && summary.at("stop_reason") == "abort";
    ++outcome.runs;
    outcome.finished += row.finished;
    outcome.crashed += crashed;
    outcome.landed += landed;
    outcome.seconds = std::max(outcome.seconds, summary.at("flight_time_s").get<double>() - kAt);
    // A crash says more than a landing.
    if (!row.finished && (outcome.first_lost.empty() || (crashed && outcome.crashed == 1)))
      outcome.first_lost = "seed " + std::to_string(seed) + " " + row.cause;
    const nlohmann::ordered_json& rmse = summary.at("estimation_rmse_m");
    if (!rmse.is_array()) continue;  // no gate was passed
    if (std::any_of(rmse.begin(), rmse.end(), [](const auto& axis) { return axis.is_null(); })) {
      outcome.finite = false;
      continue;
    }
    const auto x = rmse.at(0).get<double>(), y = rmse.at(1).get<double>(),
               z = rmse.at(2).get<double>();
    errors.push_back(std::sqrt(x * x + y * y + z * z));
    outcome.height_error = std::max(outcome.height_error, z);
    outcome.side_error = std::max({outcome.side_error, x, y});
  }
  std::sort(errors.begin(), errors.end());
  if (!errors.empty()) outcome.error = errors[errors.size() / 2];
  return outcome;
}

/// What the rule asks for and the runs did not do; "" when they did it all.
std::string unmet(const PassRule& rule, const FaultOutcome& outcome, double error_without) {
  std::vector<std::string> why;
  if (!outcome.finite) why.push_back("an estimate that is no number");
  const int rest = outcome.runs - outcome.finished;
  if (outcome.finished < rule.finished * outcome.runs ||
      (rule.others_land && rest > outcome.landed))
    why.push_back(outcome.first_lost);
  if (outcome.seconds > rule.most_seconds)
    why.push_back("ends " + files::fixed(outcome.seconds, 1) + " s after it");
  if (outcome.height_error >= rule.most_height_error)
    why.push_back(files::fixed(outcome.height_error, 2) + " m of height");
  if (outcome.side_error >= rule.most_side_error)
    why.push_back(files::fixed(outcome.side_error, 2) + " m to the side");
  if (outcome.error >= rule.most_error_ratio * error_without)
    why.push_back("error of " + files::fixed(outcome.error, 2) + " m, F0's is " +
                  files::fixed(error_without, 2) + " m");
  std::string text;
  for (const std::string& each : why) text += (text.empty() ? "" : "; ") + each;
  return text;
}

/// Both tables, row by row.
class FaultTables {
 public:
  void add(const FaultRow& row, const std::string& settings, const FaultOutcome& outcome,
           const std::string& why_not) {
    if (!row.not_injected.empty()) {
      markdown_ += "| " + row.fault + " | " + row.injected +
                   " | not injected: " + row.not_injected + " | | | | | |\n";
      csv_ += row.fault + ",\"" + row.injected + "\",,,,,,,\"not injected: " + row.not_injected +
              "\"\n";
      return;
    }
    const auto number = [](int count) { return std::to_string(count); };
    const std::string met = why_not.empty() ? "met" : "not yet: " + why_not;
    markdown_ += "| " + row.fault + " | " + row.injected + (row.rendered ? ", rendered" : "") +
                 " | " + number(outcome.runs) + " | " + number(outcome.finished) + " | " +
                 number(outcome.landed) + " | " + number(outcome.crashed) + " | " + row.rule.text +
                 " | " + met + " |\n";
    csv_ += row.fault + ",\"" + row.injected + "\",\"" + settings + "\"," + number(outcome.runs) +
            "," + number(outcome.finished) + "," + number(outcome.landed) + "," +
            number(outcome.crashed) + ",\"" + row.rule.text + "\",\"" + met + "\"\n";
  }
  void write(const fs::path& out) const {
    files::write_files(std::vector<files::FileContent>{{out / "faults.csv", csv_},
                                                       {out / "faults.md", markdown_}});
  }
  [[nodiscard]] const std::string& markdown() const { return markdown_; }

 private:
  std::string markdown_ =
      "| fault | injected | runs | finished | landed | crashed | rule | |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  std::string csv_ = "fault,injected,settings,runs,finished,landed,crashed,rule,met\n";
};

/// The rows that are asked for; F0 always, with which others are compared.
std::vector<FaultRow> chosen_rows(const std::vector<std::string>& only) {
  std::vector<FaultRow> rows = fault_rows();
  const auto is = [](const std::string& name) {
    return [&name](const FaultRow& row) { return row.fault == name; };
  };
  for (const std::string& name : only)
    if (std::none_of(rows.begin(), rows.end(), is(name)))
      throw std::runtime_error("--only " + files::one_line(name) + ": must be of F0 to F20");
  if (!only.empty())
    std::erase_if(rows, [&](const FaultRow& row) {
      return row.fault != "F0" && std::find(only.begin(), only.end(), row.fault) == only.end();
    });
  return rows;
}

}  // namespace

int fault_suite(const FaultSuiteOptions& options) {
  const fs::path out = options.out;
  const std::vector<FaultRow> rows = chosen_rows(options.only);
  expect_seeds({.first = options.first_seed, .runs = static_cast<std::uint64_t>(options.runs)});
  files::check_output_folder("--out", out);
  files::refuse_foreign_folder(out, "faults.csv", {"fault table", "fault,injected,settings"},
                               "choose another --out");
  FaultTables tables;
  double error_without = 0.0;
  std::string last;
  int level = 0;
  for (const FaultRow& row : rows) {
    level = row.fault == last ? level + 1 : 1;
    last = row.fault;
    if (!row.not_injected.empty()) {
      tables.add(row, "", {}, "");
      continue;
    }
    RaceOptions race = options.race;
    race.vision = row.rendered ? "rendered" : "ideal";
    std::string settings;
    for (const std::string& setting : row.settings) {
      race.common.settings.push_back(setting);
      settings += (settings.empty() ? "" : " ") + setting;
    }
    const int runs = row.rendered ? std::min(options.runs, kMostRendered) : options.runs;
    const simulated_race::RaceMaker maker = race_maker(race);
    (void)maker.race(options.first_seed);
    if (!fs::exists(out / "faults.csv")) {  // all arguments are right: made, and known as ours
      fs::create_directories(out);
      tables.write(out);
    }
    const CampaignFolder folder =
        flown(maker, race, {.first = options.first_seed, .runs = static_cast<std::uint64_t>(runs)},
              out / (row.fault + "-" + std::to_string(level)), options.jobs);
    if (interrupted()) {
      std::cerr << "gatefly campaign: interrupted in " << folder.path().string()
                << ", finished runs are kept; the same command flies the rest\n";
      return kInterrupted;
    }
    (void)folder.finish(folder.rows());
    const FaultOutcome outcome = outcome_of(folder);
    if (row.fault == "F0") error_without = outcome.error;
    tables.add(row, settings, outcome, unmet(row.rule, outcome, error_without));
    tables.write(out);
  }
  std::cout << tables.markdown();
  if (!options.race.common.quiet) std::cerr << "files: " << out.string() << "/\n";
  return kDone;
}

}  // namespace gatefly::cli
