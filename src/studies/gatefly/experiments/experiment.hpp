// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {

using files::fixed;   // how all tables print numbers
using files::number;  // ... and all JSON holds them

/// Settings of an experiment.
struct Options {
  std::string data;    ///< Folder of real data; "": $GATEFLY_DATA, else ../shared/data.
  bool quick = false;  ///< Fewer points and repeats: seconds instead of minutes.
  std::optional<std::uint64_t> first_seed = {};  ///< Instead of the experiment's own.
  std::function<void(double part, const std::string& text)> progress = [](double,
                                                                          const std::string&) {};
  std::function<bool()> stopped = [] { return false; };  ///< Asked often; true ends it by Stopped.
};

/// Thrown by an experiment that was told to stop.
struct Stopped {};

/// One line of the table that is printed.
struct Comparison {
  std::string what, paper, ours;
};

/// A picture beside an experiment's plot.
struct ExtraPicture {
  std::string name;  ///< Name of its file, without ".png".
  drawing::Canvas picture;
};

struct Result {
  std::vector<Comparison> table;
  nlohmann::ordered_json json;  ///< The same and more, as numbers.
  std::string csv;              ///< With its header.
  drawing::Canvas picture;
  std::vector<ExtraPicture> extra = {};  ///< Pictures beside the plot.
};

/// A section of docs/paper/deviations.md that says why ours differs.
struct Deviation {
  std::string anchor, title;
};

struct Experiment {
  std::string name, what;
  /// @throws std::runtime_error one line: data that is missing or wrong.
  Result (*run)(const Options& options);
  bool needs_data = true;  ///< Else it is simulated, or says what it leaves out without.
  std::vector<Deviation> deviations = {};
  bool takes_seeds = false;  ///< One after the other, from Options::first_seed on.
};

/// All that there are, in the paper's order.
[[nodiscard]] std::span<const Experiment> all();

/// Runs one, and marks the results of a quick run: `"quick"` in the JSON, a stamp on each picture.
/// @throws Stopped, and what the experiment throws.
[[nodiscard]] Result run(const Experiment& experiment, const Options& options);

/// The seed to begin with: the one that was asked for, else the experiment's own in full (kept for
/// reports) or of a quick run (one that was tuned on).
[[nodiscard]] std::uint64_t first_seed(const Options& options, std::uint64_t reported,
                                       std::uint64_t looked_at);

/// A folder below the real data. @throws std::runtime_error saying how to name it when it is not
/// there.
[[nodiscard]] std::filesystem::path data_folder(const std::string& name, const Options& options);

Result roc_length(const Options& options);
Result roc_fitness(const Options& options);
Result tpr_distance(const Options& options);
Result twin_hardness(const Options& options);
Result approach_sequence(const Options& options);
Result blind_real(const Options& options);
Result ahrs_real(const Options& options);
Result eyes_real(const Options& options);
Result ekf_track(const Options& options);
Result ekf_vs_15(const Options& options);
Result arc_accuracy(const Options& options);
Result convergence(const Options& options);
Result own_detector(const Options& options);
Result robustness(const Options& options);
Result false_alarms(const Options& options);
Result detection_failures(const Options& options);
Result pose_ls_p3p(const Options& options);
Result pose_bars(const Options& options);
Result pose_grid(const Options& options);
Result pose_real(const Options& options);
Result feasible_set(const Options& options);
Result full_track(const Options& options);
Result speed_ladder(const Options& options);
Result paper_vs_ours(const Options& options);
Result twin_liveliness(const Options& options);
Result other_camera(const Options& options);
Result wide_gates(const Options& options);

}  // namespace gatefly::experiments
