// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>

#include <sys/ioctl.h>
#include <unistd.h>

#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

volatile std::sig_atomic_t was_interrupted = 0;

void on_interrupt(int signal) {
  was_interrupted = signal;
  std::signal(signal, SIG_DFL);  // the second Ctrl-C ends the program
}

bool on_terminal() {
  static const bool terminal = isatty(STDERR_FILENO) == 1;
  return terminal;
}

/// Of stderr; 80 where it does not say.
std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void catch_interrupt() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}
bool interrupted() { return was_interrupted != 0; }
int interrupting_signal() { return was_interrupted; }

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
  for (const std::string& note : notes) std::cerr << "gatefly: " << note << '\n';
}

void add_force(Command& command, CommonOptions& options) {
  command.flag("--force", options.force, "replace files that are not earlier ones of this command");
}

void check_outputs(std::vector<io::Output> outputs, std::vector<std::filesystem::path> inputs,
                   const CommonOptions& options) {
  std::erase_if(outputs, [](const io::Output& output) { return output.path.empty(); });
  std::erase_if(inputs, [](const auto& input) { return input.empty(); });
  const auto configs = io::config_files(options.configs);
  inputs.insert(inputs.end(), configs.begin(), configs.end());
  io::check_outputs(outputs, inputs, options.force);
}

io::Config load(const CommonOptions& options) {
  io::Config config = tasks::load(options);
  say_notes(config.notes);
  return config;
}

bool Progress::due(double at) {
  if (quiet_) return false;
  const double now = on_terminal() ? wall_seconds() : at;
  if (now < next_) return false;
  const bool first = next_ == 0.0;
  next_ = now + (on_terminal() ? 0.1 : every_);
  return on_terminal() || !first;
}

void Progress::update(double part, const std::string& text) {
  if (!on_terminal()) {
    std::cerr << text << '\n';
    return;
  }
  // What is wider than the terminal would begin a line of its own with every update.
  constexpr std::size_t kWidth = 24, kLeast = 10;
  const std::size_t columns = terminal_columns() - 1;
  const bool has_room = columns >= kWidth + 2 + text.size();
  const auto full = static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * kWidth);
  std::string bar;
  for (std::size_t i = 0; i < kWidth && has_room; ++i) bar += i < full ? "█" : "░";
  std::cerr << "\r\033[K" << bar << (has_room ? "  " : "")
            << io::one_line(text, std::max(columns, kLeast)) << std::flush;
  shown_ = true;
}

void Progress::clear() {
  if (shown_) std::cerr << "\r\033[K" << std::flush;
  shown_ = false;
}

}  // namespace gatefly::cli
