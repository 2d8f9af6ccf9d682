// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "gatefly/config/config.hpp"

namespace gatefly::cli {

inline constexpr int kDone = 0;        ///< The work is done.
inline constexpr int kAnswerIsNo = 1;  ///< It ran, but e.g. the race was not finished.
/// Arguments or input; thrown as std::exception, caught in main.
inline constexpr int kUnusable = 2;
inline constexpr int kInterrupted = 130;  ///< Ctrl-C.

/// What the chosen subcommand does, once everything is parsed. Answers the exit code.
using Run = std::function<int()>;

// One file per subcommand. Each adds itself to `app` and, when chosen, puts its work into `run`:
//
//   void add_replay(CLI::App& app, Run& run) {
//     auto options = std::make_shared<ReplayOptions>();
//     CLI::App* command = app.add_subcommand("replay", "a recorded flight through ...");
//     command->footer("Example:\n  gatefly replay out/showroom-1 --csv estimates.csv");
//     command->add_option("DIR", options->directory, "...")->required();
//     add_common(*command, options->common);
//     command->callback([options, &run] { run = [options] { return replay(*options); }; });
//   }
void add_fly(CLI::App& app, Run& run);
void add_config(CLI::App& app, Run& run);
void add_replay(CLI::App& app, Run& run);
void add_detect(CLI::App& app, Run& run);
void add_score(CLI::App& app, Run& run);
void add_campaign(CLI::App& app, Run& run);
void add_reproduce(CLI::App& app, Run& run);
void add_identify(CLI::App& app, Run& run);
void add_bench(CLI::App& app, Run& run);
void add_calibrate(CLI::App& app, Run& run);
void add_tune(CLI::App& app, Run& run);

/// Flags that every subcommand has.
struct CommonOptions {
  std::vector<std::string> configs;   ///< --config, in order.
  std::vector<std::string> settings;  ///< --set section.key=value, in order.
  bool quiet = false;
};
void add_common(CLI::App& command, CommonOptions& options);

/// configs/default.toml, then --config, then --set. @throws std::runtime_error one line.
[[nodiscard]] io::Config load(const CommonOptions& options);

/// Ctrl-C from now on sets a flag instead of ending the program; a second one ends it.
void catch_interrupt();
[[nodiscard]] bool interrupted();

/// How far a long piece of work is, on stderr: a bar on a terminal, else a line now and then.
class Progress {
 public:
  /// @param every  between two lines when stderr is no terminal, in units of `at`.
  Progress(bool quiet, double every) : quiet_{quiet}, every_{every} {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// True when it is time for update(): cheap, to be asked often.
  [[nodiscard]] bool due(double at);
  /// @param part  0..1 of the work; @param text  what to say beside it.
  void update(double part, const std::string& text);
  void clear();

 private:
  bool quiet_ = false;
  double every_ = 10.0, next_ = 0.0;
  bool shown_ = false;
};

}  // namespace gatefly::cli
