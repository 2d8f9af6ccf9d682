// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <initializer_list>
#include <iostream>
#include <set>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

#include "gatefly/files/pictures.hpp"
#include "gatefly/files/printed.hpp"
#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

volatile std::sig_atomic_t was_interrupted = 0;

void on_interrupt(int signal) {
  was_interrupted = signal;
  std::signal(signal, SIG_DFL);  // the second Ctrl-C ends the program
}

/// Nothing but system calls: it may come in the middle of anything.
void on_interrupt_at_once(int signal) {
  constexpr std::string_view kLine = "gatefly: interrupted\n";
  (void)!::write(STDERR_FILENO, kLine.data(), kLine.size());
  ::_exit(128 + signal);
}

/// Ignored signals stay ignored: SIGHUP under nohup.
void on_signals(void (*act)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, act) == SIG_IGN && signal == SIGHUP) std::signal(signal, SIG_IGN);
}

bool on_terminal() {
  static const bool terminal = isatty(STDERR_FILENO) == 1;
  return terminal;
}

/// Width of the terminal on stderr; if unknown $COLUMNS, else 80.
std::size_t terminal_columns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* const told = std::getenv("COLUMNS");
  const int columns = told == nullptr ? 0 : std::atoi(told);
  return columns > 0 ? static_cast<std::size_t>(columns) : 80;
}

/// Number of characters in UTF-8 text.
std::size_t letters(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

/// "40 s", "12 min", "3.5 h".
std::string duration_text(double seconds) {
  if (seconds < 90.0) return files::fixed(std::ceil(seconds), 0) + " s";
  if (seconds < 90.0 * 60.0) return files::fixed(seconds / 60.0, 0) + " min";
  return files::fixed(seconds / 3600.0, 1) + " h";
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void end_when_interrupted() { on_signals(on_interrupt_at_once); }
void catch_interrupt() { on_signals(on_interrupt); }
bool interrupted() { return was_interrupted != 0; }
int interrupting_signal() { return was_interrupted; }
void stop_if_interrupted() {
  if (interrupted()) throw Interrupted{};
}

void add_common(Command& command, CommonOptions& options) {
  command
      .option("--config", options.configs,
              "configuration: a file or a name in configs/; may be given again, the later wins")
      .one_value_each()
      .type_name("FILE");
  command
      .option("--set", options.settings,
              "one key, after all files; may be given again; see gatefly config --show")
      .one_value_each()
      .type_name("SECTION.KEY=VALUE");
  command.flag("-q,--quiet", options.quiet, "no progress, as few words as possible");
}

void say_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    std::cerr << "gatefly: " << files::one_line(note, note.size()) << '\n';
}

void add_force(Command& command, CommonOptions& options) {
  command.flag("--force", options.force, "replace files that are not earlier ones of this command");
}

void check_outputs(std::vector<files::Output> outputs, std::vector<std::filesystem::path> inputs,
                   const CommonOptions& options) {
  std::erase_if(outputs, [](const files::Output& output) { return output.path.empty(); });
  std::erase_if(inputs, [](const auto& input) { return input.empty(); });
  const auto configs = config::config_files(options.configs);
  inputs.insert(inputs.end(), configs.begin(), configs.end());
  files::check_outputs(outputs, inputs, options.force);
}

std::filesystem::path data_at(const std::filesystem::path& path, const std::string& data) {
  const std::filesystem::path found = files::find_data(path, data);
  static std::set<std::filesystem::path> said;
  if (found != path && files::below_shared_data(path) != path && said.insert(path).second)
    std::cerr << "gatefly: " << path.string() << ": is not there, taken from " << found.string()
              << '\n';
  return found;
}

config::Config load(const CommonOptions& options) {
  config::Config config = tasks::load(options);
  say_notes(config.notes);
  return config;
}

std::ostream& operator<<(std::ostream& stream, const Coloured& said) {
  const auto set = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string_view{value == nullptr ? "" : value};
  };
  static const bool wanted =
      isatty(STDOUT_FILENO) == 1 && set("NO_COLOR").empty() && set("TERM") != "dumb";
  const auto in_between = [&](const char* sequence) {
    const files::AsItIs ours;
    if (wanted) stream << sequence;
  };
  in_between(said.good ? "\033[32m" : "\033[31m");
  stream << said.text;
  in_between("\033[0m");
  return stream;
}

bool Progress::due(double at) {
  if (quiet_) return false;
  if (start_ == 0.0) start_ = wall_seconds();
  const double now = on_terminal() ? wall_seconds() : at;
  if (now < next_) return false;
  const bool first = next_ == 0.0;
  next_ = now + (on_terminal() ? 0.1 : every_);
  return on_terminal() || !first;
}

void Progress::update(double part, const std::string& text) {
  part = std::clamp(part, 0.0, 1.0);
  const double so_far = wall_seconds() - start_;
  const std::string left =
      part > 0.0 ? duration_text(so_far * (1.0 - part) / part) + " left" : std::string{};
  const std::string between = left.empty() ? "" : ", ";
  if (!on_terminal()) {
    std::cerr << text << between << left << '\n';
    return;
  }
  // A text wider than the terminal would begin a new line with every update: the bar goes
  // first, then the words.
  constexpr std::size_t kWidth = 24, kNarrow = 6, kLeast = 10;
  const std::size_t columns = std::max(terminal_columns(), kLeast + 1) - 1;
  std::string words = text + between + left;
  if (letters(words) > columns) words = files::fixed(100.0 * part, 0) + " %" + between + left;
  const std::size_t taken = letters(words) + 2;
  const std::size_t width = columns < taken + kNarrow ? 0 : std::min(kWidth, columns - taken);
  const auto full = static_cast<std::size_t>(part * static_cast<double>(width));
  std::string bar;
  for (std::size_t i = 0; i < width; ++i) bar += i < full ? "█" : "░";
  clear();
  std::cerr << bar << (width > 0 ? "  " : "")
            << files::one_line(words, letters(words) > columns ? columns : words.size())
            << std::flush;
  shown_ = true;
}

void Progress::clear() {
  const files::AsItIs ours;
  if (shown_) std::cerr << "\r\033[K" << std::flush;
  shown_ = false;
}

}  // namespace gatefly::cli
