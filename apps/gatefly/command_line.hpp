// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

// Declarations of a subcommand's flags and arguments. CLI11 does the work, in command_line.cpp alone:
// its header in every command was a quarter of the build.

namespace gatefly::cli {

/// Action of the chosen subcommand, called after parsing. Returns the exit code.
using Run = std::function<int()>;

/// One argument or flag, while it is declared.
class Flag {
 public:
  explicit Flag(CLI::Option* option) : option_{option} {}

  Flag& required();
  Flag& type_name(const char* name);  ///< Placeholder of the value in --help: FILE, DIR, ...
  Flag& path(const char* name = "");  ///< A file or folder; type_name() if any.
  Flag& show_default();               ///< The value it has now, in --help.
  Flag& one_of(std::initializer_list<const char*> choices);
  Flag& one_of(std::initializer_list<int> choices);
  Flag& between(int low, int high);
  Flag& between(double low, double high);
  Flag& one_value_each();              ///< --flag A --flag B, never --flag A B.
  Flag& separated_by(char separator);  ///< --flag A,B as well.
  Flag& needs(const Flag& other);
  Flag& excludes(const Flag& other);

 private:
  CLI::Option* option_;
};

/// An argument or flag as --help tells it.
struct FlagInfo {
  std::vector<std::string> names;  ///< "-q", "--quiet"; none: an argument.
  std::string value;               ///< Placeholder of its value: FILE; "" when it takes none.
  std::string help;
  std::vector<std::string> choices;  ///< When the value is one of a few words.
  bool required = false, repeated = false;
};

/// A subcommand as --help tells it.
struct CommandInfo {
  std::string name, help, footer;
  std::vector<FlagInfo> flags;
};
[[nodiscard]] std::vector<CommandInfo> commands_of(const CLI::App& program);

/// A subcommand, while it is declared. Values are written when its line is parsed: they must live
/// as long as what runs() is given.
class Command {
 public:
  explicit Command(CLI::App* app, Run& run) : app_{app}, run_{run} {}

  /// An argument ("PATH") or a flag with a value ("--out"), which is not empty.
  Flag option(const char* name, std::string& value, const char* help);
  Flag option(const char* name, std::vector<std::string>& value, const char* help);
  Flag option(const char* name, int& value, const char* help);
  Flag option(const char* name, std::uint64_t& value, const char* help);
  Flag option(const char* name, double& value, const char* help);
  Flag option(const char* name, std::optional<int>& value, const char* help);
  Flag option(const char* name, std::optional<std::uint64_t>& value, const char* help);
  Flag option(const char* name, std::optional<double>& value, const char* help);
  /// A flag without a value.
  Flag flag(const char* name, bool& value, const char* help);

  void footer(const std::string& text);  ///< At the end of --help: an example, exit codes.
  void runs(Run work);                   ///< When this is the chosen command.
  /// All commands of the program, to be asked when they are declared.
  [[nodiscard]] std::vector<CommandInfo> all() const;

 private:
  CLI::App* app_;
  Run& run_;
};

}  // namespace gatefly::cli
