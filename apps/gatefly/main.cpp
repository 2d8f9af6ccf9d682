// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <exception>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "gatefly/files/text.hpp"

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
      return io::suggestion(flag, flags);
  }
  return "";
}

/// One line for a wrong command line; the text of --help and --version otherwise.
int parse_failed(CLI::App& app, const CLI::ParseError& error, std::span<char* const> arguments) {
  if (error.get_exit_code() == 0) return app.exit(error);
  const auto chosen = app.get_subcommands();
  CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string what = io::one_line(error.what(), 4000);
  std::cerr << "gatefly" << (chosen.empty() ? "" : " " + command.get_name()) << ": " << what
            << flag_suggestion(command, arguments) << " (--help shows what there is)\n";
  return kUnusable;
}

int run_main(std::span<char* const> arguments) {
  CLI::App app{"Flies a drone through a course of gates with one camera, an IMU and a sonar.",
               "gatefly"};
  app.set_version_flag("--version", std::string{"gatefly "} + GATEFLY_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example:\n  gatefly fly showroom --seed 7\n\ngatefly COMMAND --help says more about a "
      "command.");
  Run run;
  add_fly(app, run);
  add_replay(app, run);
  add_detect(app, run);
  add_score(app, run);
  add_calibrate(app, run);
  add_tune(app, run);
  add_campaign(app, run);
  add_reproduce(app, run);
  add_identify(app, run);
  add_bench(app, run);
  add_config(app, run);

  if (arguments.size() > 1 && arguments[1][0] != '-') {
    const std::string name = arguments[1];
    const auto names = command_names(app);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      std::cerr << "gatefly: no command '" << io::one_line(name) << "'"
                << io::suggestion(name, names) << " (there are: " << io::joined(names) << ")\n";
      return kUnusable;
    }
  }
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::ParseError& error) {
    return parse_failed(app, error, arguments);
  }
  return run();
}

}  // namespace
}  // namespace gatefly::cli

/// gatefly COMMAND ...: exit 0 done, 1 the answer is no, 2 unusable arguments or input, 130 Ctrl-C.
int main(int argc, char** argv) try {
  return gatefly::cli::run_main({argv, static_cast<std::size_t>(argc)});
} catch (const std::exception& error) {
  std::cerr << "gatefly: " << gatefly::io::one_line(error.what(), 4000) << '\n';
  return gatefly::cli::kUnusable;
}
