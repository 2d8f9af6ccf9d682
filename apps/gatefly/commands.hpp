// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/tasks/arguments.hpp"

#include "command_line.hpp"

namespace gatefly::cli {

inline constexpr int kDone = 0;        ///< The work is done.
inline constexpr int kAnswerIsNo = 1;  ///< It ran, but e.g. the race was not finished.
/// Arguments or input; thrown as std::exception, caught in main.
inline constexpr int kUnusable = 2;
inline constexpr int kInterrupted =
    130;  ///< Ctrl-C; main() makes it 143 for SIGTERM, 129 for SIGHUP.

// One file per subcommand. Each declares its command line and what to do when it is chosen:
//
//   void declare_replay(Command& command) {
//     auto options = std::make_shared<ReplayOptions>();
//     command.footer("Example:\n  gatefly replay out/showroom-1 --csv estimates.csv");
//     command.option("DIR", options->directory, "...").required();
//     add_common(command, options->common);
//     command.runs([options] { return replay(*options); });
//   }
void declare_fly(Command& command);
void declare_config(Command& command);
void declare_replay(Command& command);
void declare_run(Command& command);
void declare_import(Command& command);
void declare_record(Command& command);
void declare_bench_drone(Command& command);
void declare_link_sim(Command& command);
void declare_detect(Command& command);
void declare_score(Command& command);
void declare_campaign(Command& command);
void declare_reproduce(Command& command);
void declare_identify(Command& command);
void declare_bench(Command& command);
void declare_calibrate(Command& command);
void declare_tune(Command& command);
void declare_map(Command& command);
void declare_new(Command& command);
void declare_track(Command& command);
void declare_doctor(Command& command);
void declare_view(Command& command);
void declare_render(Command& command);
void declare_completion(Command& command);

/// A subcommand that is compiled into this program.
struct CommandHere {
  std::string_view name;
  void (*declare)(Command& command);      ///< nullptr: needs what was left out.
  const char* laboratory_flag = nullptr;  ///< With this flag it is the laboratory's.
};
/// Which these are: commands_of_*.cpp. What flies is in `gatefly`; what looks at flights and pictures,
/// and flies many, in `gatefly-tools`; what takes a laboratory's libraries (Ceres, OpenCV) in
/// `gatefly-lab`; the studies, built when they are asked for, in `gatefly-studies`. Each calls the
/// others, so that the first flight need not wait for them to be built.
/// Without the simulator all that is left is in `gatefly`: commands_without_simulator.cpp.
[[nodiscard]] std::span<const CommandHere> commands_here();
inline constexpr const char* kProgram = "gatefly";
inline constexpr const char* kTools = "gatefly-tools";
inline constexpr const char* kLaboratory = "gatefly-lab";
inline constexpr const char* kStudies = "gatefly-studies";
/// Path of the program of this name beside this one, if it exists.
[[nodiscard]] std::filesystem::path sibling(const char* program);

/// Flags that every subcommand has.
struct CommonOptions : tasks::ConfigArguments {  // --config and --set
  bool quiet = false;
  bool force = false;  ///< --force, of those that write files.
};
void add_common(Command& command, CommonOptions& options);
void add_force(Command& command, CommonOptions& options);

/// Before the work: refuses what files::check_outputs() refuses, for which --config is an input, too.
/// An output without a path is not asked for.
void check_outputs(std::vector<files::Output> outputs, std::vector<std::filesystem::path> inputs,
                   const CommonOptions& options);

/// Prints a configuration's warnings on stderr.
void say_notes(const std::vector<std::string>& notes);

/// files::find_data(), saying so when what was called ../shared/data/X lies elsewhere.
[[nodiscard]] std::filesystem::path data_at(const std::filesystem::path& path,
                                            const std::string& data);

/// configs/default.toml, then --config, then --set. @throws std::runtime_error one line.
[[nodiscard]] config::Config load(const CommonOptions& options);

/// Ctrl-C, SIGTERM and SIGHUP end the program at once, in one line and with the right exit code: from
/// its first moment on, until it has something to lose.
void end_when_interrupted();
/// From now on they only set a flag; a second one ends the program. Before anything is written.
void catch_interrupt();
[[nodiscard]] bool interrupted();
/// Which of them it was.
[[nodiscard]] int interrupting_signal();

/// Thrown by stop_if_interrupted(); run_main() says that nothing is kept.
struct Interrupted {};
/// For who works long: what is half done goes as the stack is unwound.
void stop_if_interrupted();

/// `text` to be printed in green or red where standard output is a terminal and $NO_COLOR is not
/// set.
struct Coloured {
  bool good;
  std::string text;
};
std::ostream& operator<<(std::ostream& stream, const Coloured& said);
[[nodiscard]] inline Coloured coloured(bool good, std::string text) {
  return {good, std::move(text)};
}

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
  /// Says how long the rest takes, too, if it goes on as it has; fits the terminal's width.
  /// @param part  0..1 of the work
  /// @param text  what to say beside it
  void update(double part, const std::string& text);
  void clear();

 private:
  bool quiet_ = false;
  double every_ = 10.0, next_ = 0.0, start_ = 0.0;
  bool shown_ = false;
};

}  // namespace gatefly::cli
