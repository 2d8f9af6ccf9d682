// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <span>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <unistd.h>

#include "gatefly/files/printed.hpp"
#include "gatefly/files/text.hpp"

#include "command_tree.hpp"
#include "commands.hpp"

namespace gatefly::cli {
namespace {

std::vector<std::string> command_names(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

/// ", did you mean '--seed'?" for the first flag that the command does not have.
std::string flag_suggestion(CLI::App& command, std::span<char* const> arguments) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  for (const std::string argument : arguments) {
    const std::string flag = argument.substr(0, argument.find('='));
    if (flag.starts_with("--") && std::find(flags.begin(), flags.end(), flag) == flags.end())
      return files::suggestion(flag, flags);
  }
  return "";
}

/// One line for a wrong command line; the text of --help and --version otherwise.
int parse_failed(CLI::App& app, const CLI::ParseError& error, std::span<char* const> arguments) {
  if (error.get_exit_code() == 0) return app.exit(error);
  const auto chosen = app.get_subcommands();
  CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string what = files::reason_of(error);
  std::cerr << "gatefly" << (chosen.empty() ? "" : " " + command.get_name()) << ": " << what
            << flag_suggestion(command, arguments) << " (--help shows what there is)\n";
  return kUnusable;
}

struct Listed {
  const char* name;
  const char* help;
  const char* program;  ///< Name of the program that contains the command.
};
/// All commands there are, in the order of --help.
constexpr std::array kCommands{
    Listed{"fly", "one closed-loop race in the simulator", kProgram},
    Listed{"render", "labelled pictures of a course, from races and from all around", kTools},
    Listed{"replay", "a recorded flight through the pilot that flies the simulator", kTools},
    Listed{"run", "a real drone's camera and flight controller through the pilot", kLaboratory},
    Listed{"bench-drone", "a drone on the bench: what is wrong with it, and its drone.toml",
           kLaboratory},
    Listed{"link-sim", "a simulated drone behind a real flight controller's program, in real time",
           kLaboratory},
    Listed{"record", "a drone's camera and flight controller, a folder a battery; nobody flies",
           kLaboratory},
    Listed{"import", "a log of another program (blackbox, ULog, ROS) as a flight folder",
           kLaboratory},
    Listed{"detect", "gates in images, folders, or a video", kTools},
    Listed{"score", "detections against labels", kTools},
    Listed{"calibrate", "a camera from pictures of a checkerboard or corner lists", kLaboratory},
    Listed{"tune", "a gate's colours and the detector's threshold, fitted to pictures",
           kLaboratory},
    Listed{"campaign", "many seeded races: how often, how fast, and what went wrong", kTools},
    Listed{"reproduce", "the paper's figures and tables, \"paper | ours\"", kStudies},
    Listed{"identify", "a drone's constants from recorded flights: drag, or thrust and camera",
           kLaboratory},
    Listed{"map", "a course as recorded flights have learnt it, with how sure that is",
           kLaboratory},
    Listed{"bench", "the stage-by-stage cost, each beside its baseline", kStudies},
    Listed{"new", "a commented track, camera or configuration to start from", kTools},
    Listed{"track", "checks and draws a course: can it be flown, how long, how fast", kTools},
    Listed{"view", "shows a flight, a folder of flights or a campaign to the browser", kTools},
    Listed{"doctor", "what is installed, which data is found, what to do about the rest", kProgram},
    Listed{"config", "every configuration key with value, unit and source", kProgram},
    Listed{"completion", "completes commands in your shell: bash, zsh, fish", kTools},
};

/// Why a command is not in this program.
const char* why_left_out(std::string_view name) {
  if (name == "calibrate" || name == "tune")
    return "this program was built without Ceres and OpenCV";
  return "this program was built without the simulator";
}

const CommandHere* find_here(std::string_view name) {
  const auto here = commands_here();
  const auto found =
      std::find_if(here.begin(), here.end(), [&](const auto& c) { return c.name == name; });
  return found == here.end() ? nullptr : &*found;
}

/// Becomes the program that has this command. Returns only when it is not there.
int call_sibling(const std::string& name, const char* program, char** argv) {
  const auto self = std::filesystem::read_symlink("/proc/self/exe"), other = sibling(program);
  if (self != other && std::filesystem::exists(other)) execv(other.c_str(), argv);
  std::cerr << "gatefly " << name << ": " << other.string()
            << (std::filesystem::exists(other)
                    ? ": was built without it\n"
                    : ": is not there; build it, or start gatefly by ./gatefly\n");
  return kUnusable;
}

const char* program_of(std::string_view name) {
  const auto listed = std::find_if(kCommands.begin(), kCommands.end(),
                                   [&](const Listed& one) { return one.name == name; });
  return listed == kCommands.end() ? kProgram : listed->program;
}

bool is_for_laboratory(const CommandHere& command, std::span<char* const> arguments) {
  return command.laboratory_flag != nullptr &&
         std::any_of(arguments.begin(), arguments.end(), [&](const char* argument) {
           const std::string_view given{argument};
           return given.substr(0, given.find('=')) == command.laboratory_flag;
         });
}

/// "help fly" is "fly --help", "version" is "--version", "help --man" the manual page; ends with a
/// nullptr, as execv wants it.
std::vector<char*> spelled_out(std::span<char*> arguments) {
  static char help[] = "--help", version[] = "--version", completion[] = "completion",
              man[] = "man";
  std::vector<char*> words(arguments.begin(), arguments.end());
  const std::string_view first = words.size() > 1 ? words[1] : "";
  const std::string_view second = words.size() > 2 ? words[2] : "";
  if (first == "help" && words.size() == 2) words[1] = help;
  if (first == "help" && words.size() > 2) {
    if (second == "--man")
      words = {words[0], completion, man};
    else
      words = {words[0], words[2], help};
  }
  if (first == "version" && words.size() == 2) words[1] = version;
  words.push_back(nullptr);
  return words;
}

/// Runs the chosen command.
int run_command(const Run& run, const std::string& name) {
  int code = kInterrupted;
  try {
    code = run();
  } catch (const Interrupted&) {
    std::cerr << "gatefly " << name << ": interrupted, nothing kept\n";
  }
  return code == kInterrupted ? 128 + interrupting_signal() : code;
}

/// Answers a request from another of our programs.
void print_commands(const CLI::App& app) {
  std::vector<CommandInfo> here;
  for (CommandInfo& command : commands_of(app))
    if (const CommandHere* found = find_here(command.name); found && found->declare)
      here.push_back(std::move(command));
  std::cout << as_json(here).dump(1) << '\n';
}

int run_main(std::span<char*> given) {
  CLI::App app{"Flies a drone through a course of gates with one camera, an IMU and a sonar.",
               "gatefly"};
  app.set_version_flag("-V,--version", std::string{"gatefly "} + GATEFLY_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example:\n  gatefly fly showroom --seed 7\n\ngatefly COMMAND --help (or: gatefly help "
      "COMMAND) says more about a command;\ngatefly help --man prints the manual page.");
  Run run;
  for (const auto& [name, help, program] : kCommands) {
    const CommandHere* here = find_here(name);
    const bool left_out = here != nullptr && here->declare == nullptr;
    Command command{app.add_subcommand(name, left_out ? why_left_out(name) : help), run};
    if (here != nullptr && !left_out) here->declare(command);
  }

  std::vector<char*> words = spelled_out(given);
  const std::span<char*> arguments{words.data(), words.size() - 1};
  if (arguments.size() == 2 && std::string_view{arguments[1]} == kPrintCommands) {
    print_commands(app);
    return kDone;
  }
  if (arguments.size() > 1 && arguments[1][0] != '-') {
    const std::string name = arguments[1];
    const auto names = command_names(app);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      std::cerr << "gatefly: no command '" << files::one_line(name) << "'"
                << files::suggestion(name, names) << " (there are: " << files::joined(names)
                << ")\n";
      return kUnusable;
    }
    const CommandHere* here = find_here(name);
    if (here == nullptr) return call_sibling(name, program_of(name), arguments.data());
    if (is_for_laboratory(*here, arguments))
      return call_sibling(name, kLaboratory, arguments.data());
    if (here->declare == nullptr) {
      std::cerr << "gatefly " << name << ": " << why_left_out(name) << '\n';
      return kUnusable;
    }
  }
  if (arguments.size() == 1) {  // as the shell's newcomer types it
    std::cout << app.help();
    return kDone;
  }
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::ParseError& error) {
    return parse_failed(app, error, arguments);
  }
  return run_command(run, app.get_subcommands().front()->get_name());
}

/// A stream that is closed would give its number to the next file, which would get our words.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 &&
        open("/dev/null", stream == STDOUT_FILENO ? O_RDONLY : O_RDWR) < 0)
      std::exit(kUnusable);
  for (const int signal : {SIGPIPE, SIGXFSZ})
    std::signal(signal, SIG_IGN);  // a write fails instead
}

/// Thrown where something is printed that does not arrive.
struct StandardOutputFailed {
  int reason = errno;
};

/// Writes text for a terminal, whoever wrote what is in it: a name, a file, an argument.
bool put_printable(std::streambuf& behind, std::string_view text) {
  const auto put = [&](std::string_view piece) {
    const auto size = static_cast<std::streamsize>(piece.size());
    return behind.sputn(piece.data(), size) == size;
  };
  const bool part = text.size() == 1 && static_cast<unsigned char>(text[0]) >= 0x80;  // of a letter
  return put(part || files::AsItIs::lives() || files::is_printable(text) ? text
                                                                         : files::printable(text));
}

/// Standard error while the program runs.
class PrintableErrors : public std::streambuf {
 public:
  PrintableErrors() : behind_{std::cerr.rdbuf(this)} {}
  ~PrintableErrors() override { std::cerr.rdbuf(behind_); }
  PrintableErrors(const PrintableErrors&) = delete;
  PrintableErrors& operator=(const PrintableErrors&) = delete;

 private:
  int_type overflow(int_type c) override {
    const char letter = traits_type::to_char_type(c);
    return put_printable(*behind_, {&letter, 1}) ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    return put_printable(*behind_, {text, static_cast<std::size_t>(size)}) ? size : 0;
  }
  int sync() override { return behind_->pubsync(); }

  std::streambuf* behind_;
};

/// Standard output while the program runs: what it does not take is not just forgotten.
class WatchedOutput : public std::streambuf {
 public:
  WatchedOutput() : behind_{std::cout.rdbuf(this)} { std::cout.exceptions(std::ios::badbit); }
  ~WatchedOutput() override {
    std::cout.exceptions(std::ios::goodbit);
    std::cout.rdbuf(behind_);
  }
  WatchedOutput(const WatchedOutput&) = delete;
  WatchedOutput& operator=(const WatchedOutput&) = delete;

 private:
  int_type overflow(int_type c) override {
    const char letter = traits_type::to_char_type(c);
    xsputn(&letter, 1);
    return c;
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    if (!put_printable(*behind_, {text, static_cast<std::size_t>(size)}))
      throw StandardOutputFailed{};
    return size;
  }
  int sync() override {
    if (behind_->pubsync() != 0) throw StandardOutputFailed{};
    return 0;
  }

  std::streambuf* behind_;
};

int standard_output_failed(int reason) {
  if (reason == EPIPE) {  // head has seen enough: as any program, we end without a word
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  std::cerr << "gatefly: standard output: cannot be written: " << std::strerror(reason) << '\n';
  return kUnusable;
}

}  // namespace

std::filesystem::path sibling(const char* program) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / program;
}

}  // namespace gatefly::cli

/// gatefly COMMAND ...: exit 0 done, 1 the answer is no, 2 unusable arguments or input, 130 Ctrl-C.
int main(int argc, char** argv) try {
  gatefly::cli::end_when_interrupted();
  gatefly::cli::open_standard_streams();
  const gatefly::cli::WatchedOutput watched;
  const gatefly::cli::PrintableErrors printable;
  const int code = gatefly::cli::run_main({argv, static_cast<std::size_t>(argc)});
  std::cout.flush();
  return code;
} catch (const gatefly::cli::StandardOutputFailed& failed) {
  return gatefly::cli::standard_output_failed(failed.reason);
} catch (const std::exception& error) {
  std::cerr << "gatefly: " << gatefly::files::reason_of(error) << '\n';
  return gatefly::cli::kUnusable;
}
