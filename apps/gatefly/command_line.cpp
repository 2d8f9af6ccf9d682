// SPDX-License-Identifier: Apache-2.0
#include "command_line.hpp"

#include <charconv>
#include <cmath>
#include <system_error>
#include <type_traits>
#include <utility>

#include <CLI/CLI.hpp>

#include "gatefly/files/text.hpp"

namespace gatefly::cli {
namespace {

/// In place of CLI11's conversion, which takes the nearest number it can hold.
template <class Number>
std::string check_number(const std::string& text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + text.starts_with('+'), end, value);
  const bool is_whole = std::is_integral_v<Number>;
  if (error == std::errc::result_out_of_range && rest == end)
    return files::one_line(text) + " is too large";
  if (error != std::errc{} || rest != end || (!is_whole && !std::isfinite(value)))
    return "'" + files::one_line(text) + "', must be a " + (is_whole ? "whole number" : "number") +
           (std::is_unsigned_v<Number> ? ", 0 or more" : "");
  return "";
}

template <class Number, class Value>
CLI::Option* number(CLI::App* app, const char* name, Value& value, const char* help) {
  return app->add_option(name, value, help)->check(check_number<Number>);
}

std::string check_not_empty(const std::string& text) {
  return text.empty() ? "must not be empty" : "";
}

/// "TEXT:{rendered,ideal}" is a TEXT that is one of two words.
FlagInfo info_of(const CLI::Option& option) {
  FlagInfo info;
  info.help = option.get_description();
  info.required = option.get_required();
  info.repeated = option.get_items_expected_max() > 1;
  for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
  if (option.get_items_expected_max() == 0) return info;  // without a value
  const std::string type = option.get_type_name();
  info.value = option.get_positional() ? option.get_name() : type.substr(0, type.find(':'));
  const std::size_t open = type.find(":{"), close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return info;
  std::string word;
  for (const char c : type.substr(open + 2, close - open - 2) + ",") {
    if (c == ',') info.choices.push_back(std::exchange(word, ""));
    if (c != ',') word += c;
  }
  return info;
}

}  // namespace

std::vector<CommandInfo> commands_of(const CLI::App& program) {
  std::vector<CommandInfo> all;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    CommandInfo info{command->get_name(), command->get_description(), command->get_footer(), {}};
    for (const CLI::Option* option : command->get_options()) info.flags.push_back(info_of(*option));
    all.push_back(std::move(info));
  }
  return all;
}

Flag& Flag::required() {
  option_->required();
  return *this;
}
Flag& Flag::type_name(const char* name) {
  option_->type_name(name);
  return *this;
}
Flag& Flag::path(const char* name) {
  if (*name != '\0') option_->type_name(name);
  return *this;
}
Flag& Flag::show_default() {
  option_->capture_default_str();
  return *this;
}
Flag& Flag::one_of(std::initializer_list<const char*> choices) {
  option_->check(CLI::IsMember(std::vector<std::string>(choices.begin(), choices.end())));
  return *this;
}
Flag& Flag::one_of(std::initializer_list<int> choices) {
  option_->check(CLI::IsMember(std::vector<int>(choices)));
  return *this;
}
Flag& Flag::between(int low, int high) {
  option_->check(CLI::Range(low, high));
  return *this;
}
Flag& Flag::between(double low, double high) {
  option_->check(CLI::Range(low, high));
  return *this;
}
Flag& Flag::one_value_each() {
  option_->expected(1)->take_all()->allow_extra_args(false);
  return *this;
}
Flag& Flag::separated_by(char separator) {
  option_->delimiter(separator);
  return *this;
}
Flag& Flag::needs(const Flag& other) {
  option_->needs(other.option_);
  return *this;
}
Flag& Flag::excludes(const Flag& other) {
  option_->excludes(other.option_);
  return *this;
}

Flag Command::option(const char* name, std::string& value, const char* help) {
  return Flag{app_->add_option(name, value, help)->check(check_not_empty)};
}
Flag Command::option(const char* name, std::vector<std::string>& value, const char* help) {
  return Flag{app_->add_option(name, value, help)->check(check_not_empty)};
}
Flag Command::option(const char* name, int& value, const char* help) {
  return Flag{number<int>(app_, name, value, help)};
}
Flag Command::option(const char* name, std::uint64_t& value, const char* help) {
  return Flag{number<std::uint64_t>(app_, name, value, help)};
}
Flag Command::option(const char* name, double& value, const char* help) {
  return Flag{number<double>(app_, name, value, help)};
}
Flag Command::option(const char* name, std::optional<int>& value, const char* help) {
  return Flag{number<int>(app_, name, value, help)};
}
Flag Command::option(const char* name, std::optional<std::uint64_t>& value, const char* help) {
  return Flag{number<std::uint64_t>(app_, name, value, help)};
}
Flag Command::option(const char* name, std::optional<double>& value, const char* help) {
  return Flag{number<double>(app_, name, value, help)};
}
Flag Command::flag(const char* name, bool& value, const char* help) {
  return Flag{app_->add_flag(name, value, help)};
}

void Command::footer(const std::string& text) { app_->footer(text); }

std::vector<CommandInfo> Command::all() const { return commands_of(*app_->get_parent()); }

void Command::runs(Run work) {
  app_->callback([&run = run_, work = std::move(work)] { run = work; });
}

}  // namespace gatefly::cli
