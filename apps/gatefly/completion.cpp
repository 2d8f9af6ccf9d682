// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>
#include <string_view>

#include "gatefly/files/text.hpp"

#include "command_tree.hpp"
#include "commands.hpp"

namespace gatefly::cli {
namespace {

/// Suggestions for a value.
struct Suggested {
  std::vector<std::string> words;
  bool files = false, folders = false, no_space = false;
};

/// --set: of every command, and a long list.
bool is_set(const FlagInfo& flag) {
  return std::find(flag.names.begin(), flag.names.end(), "--set") != flag.names.end();
}
Suggested keys_of(const Words& words) { return {words.keys, false, false, true}; }

Suggested suggested(const CommandInfo& command, const FlagInfo& flag, const Words& words) {
  const auto is = [&](const char* name) {
    return std::find(flag.names.begin(), flag.names.end(), name) != flag.names.end();
  };
  if (!flag.choices.empty()) return {flag.choices};
  if (is("--config")) return {words.configs, true};
  if (is_set(flag)) return keys_of(words);
  if (is("--track") || flag.value == "TRACK") return {words.tracks, true};
  if (flag.value == "CAMERA") return {words.cameras, true};
  if (flag.value == "VEHICLE") return {words.vehicles, true};
  if (flag.value == "KEY") return {words.keys};
  if (command.name == "reproduce" && flag.names.empty()) return {words.experiments};
  if (flag.value.starts_with("DIR")) return {{}, false, true};
  if (flag.value.starts_with("FILE") || flag.value == "PATH" || flag.value == "TEXT")
    return {{}, true};
  return {};
}

/// In single quotes, as every shell takes it.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return result + "'";
}

/// The same with a backslash before each of `special`.
std::string escaped(const std::string& text, std::string_view special) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::vector<std::string> names_of(const std::vector<CommandInfo>& tree) {
  std::vector<std::string> names;
  for (const CommandInfo& command : tree) names.push_back(command.name);
  names.insert(names.end(), {"help", "version"});
  return names;
}

const FlagInfo* argument_of(const CommandInfo& command) {
  const auto found = std::find_if(command.flags.begin(), command.flags.end(),
                                  [](const FlagInfo& flag) { return flag.names.empty(); });
  return found == command.flags.end() ? nullptr : &*found;
}

std::string bash_words(const Suggested& what) {
  std::string line;
  if (!what.words.empty()) line += "words=" + quoted(files::joined(what.words, " ")) + " ";
  if (what.files) line += "others=-f ";
  if (what.folders) line += "others=-d ";
  if (what.no_space) line += "; compopt -o nospace 2>/dev/null ";
  return (line.empty() ? ": " : line) + ";;\n";
}

/// fly:--laps|fly:--seed
std::string bash_pattern(const CommandInfo& command, const FlagInfo& flag) {
  std::vector<std::string> patterns;
  for (const std::string& name : flag.names) patterns.push_back(command.name + ":" + name);
  return files::joined(patterns, "|");
}

/// [one of] 'a b' -> "(a b)" as _arguments takes it; files and folders by its own functions.
std::string zsh_action(const Suggested& what) {
  if (what.no_space) return "compadd -S= -- $keys";
  if (what.files && !what.words.empty())
    return "{_alternative " + quoted("names:name:(" + files::joined(what.words, " ") + ")") +
           " 'files:file:_files'}";
  if (what.files) return "_files";
  if (what.folders) return "_files -/";
  return what.words.empty() ? " " : "(" + files::joined(what.words, " ") + ")";
}

std::string zsh_specs(const CommandInfo& command, const Words& words) {
  std::string text;
  for (const FlagInfo& flag : command.flags) {
    const std::string help = "[" + escaped(flag.help, "[]:\\") + "]";
    const std::string action =
        flag.value.empty() ? ""
                           : ":" + flag.value + ":" + zsh_action(suggested(command, flag, words));
    const char* const again = flag.names.size() == 1 ? "*" : "";  // may be given more than once
    for (const std::string& name : flag.names)
      text += " \\\n        " + quoted(again + name + help + action);
    if (flag.names.empty()) text += " \\\n        " + quoted("*" + action);
  }
  return text;
}

std::string fish_line(const CommandInfo& command, const FlagInfo& flag, const Words& words) {
  const Suggested what = suggested(command, flag, words);
  std::string line = "complete -c gatefly -n '__fish_seen_subcommand_from " + command.name + "'";
  for (const std::string& name : flag.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!flag.value.empty() && !flag.names.empty())
    line += what.files || what.folders ? " -r" : " -x";
  if (flag.names.empty() && !what.files && !what.folders) line += " -f";
  if (what.files || what.folders) line += " -F";
  if (!what.words.empty()) line += " -a " + quoted(files::joined(what.words, " "));
  return line + " -d '" + escaped(flag.help, "'\\") + "'\n";
}

struct CompletionOptions {
  CommonOptions common;
  std::string shell;
};

/// gatefly completion: what a shell has to read to complete gatefly's commands.
int completion(const std::vector<CommandInfo>& here, const CompletionOptions& options) {
  const std::vector<CommandInfo> tree = whole_tree(here);
  if (options.shell == "man")
    std::cout << manual_page(tree);
  else if (options.shell == "bash")
    std::cout << bash_completion(tree, words_for_shells());
  else if (options.shell == "zsh")
    std::cout << zsh_completion(tree, words_for_shells());
  else
    std::cout << fish_completion(tree, words_for_shells());
  return kDone;
}

}  // namespace

std::string bash_completion(const std::vector<CommandInfo>& tree, const Words& words) {
  std::string text =
      "# bash completion for gatefly; made by: gatefly completion bash\n"
      "_gatefly() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words= others=\n"
      "  [[ $word == = ]] && word=  # --flag=value comes as three words\n"
      "  [[ $before == = ]] && before=${COMP_WORDS[COMP_CWORD-2]}\n"
      "  if ((COMP_CWORD == 1)) || [[ ${COMP_WORDS[1]} == help ]]; then\n"
      "    words=" +
      quoted(files::joined(names_of(tree), " ")) +
      "\n"
      "  else case ${COMP_WORDS[1]}:$before in\n";
  text += "    *:--set) " + bash_words(keys_of(words));
  for (const CommandInfo& command : tree)
    for (const FlagInfo& flag : command.flags)
      if (!flag.names.empty() && !flag.value.empty() && !is_set(flag))
        text += "    " + bash_pattern(command, flag) + ") " +
                bash_words(suggested(command, flag, words));
  text += "    *) case ${COMP_WORDS[1]}:$word in\n";
  for (const CommandInfo& command : tree) {
    std::vector<std::string> flags;
    for (const FlagInfo& flag : command.flags)
      flags.insert(flags.end(), flag.names.begin(), flag.names.end());
    const FlagInfo* const argument = argument_of(command);
    text += "      " + command.name + ":-*) words=" + quoted(files::joined(flags, " ")) + " ;;\n";
    if (argument != nullptr)
      text += "      " + command.name + ":*) " + bash_words(suggested(command, *argument, words));
  }
  return text +
         "    esac ;;\n"
         "  esac; fi\n"
         "  [[ -n $others ]] && compopt -o filenames 2>/dev/null\n"
         "  mapfile -t COMPREPLY < <(compgen $others -W \"$words\" -- \"$word\")\n"
         "}\n"
         "complete -F _gatefly gatefly ./gatefly\n";
}

std::string zsh_completion(const std::vector<CommandInfo>& tree, const Words& words) {
  std::string text =
      "#compdef gatefly\n# zsh completion for gatefly; made by: gatefly completion zsh\n"
      "_gatefly() {\n"
      "  local -a keys=(" +
      files::joined(words.keys, " ") +
      ")\n"
      "  if ((CURRENT == 2)); then\n"
      "    local -a commands=(\n";
  for (const CommandInfo& command : tree)
    text += "      " + quoted(command.name + ":" + command.help) + "\n";
  text +=
      "    )\n    _describe command commands\n    return\n  fi\n"
      "  shift words\n  ((CURRENT--))\n"
      "  case $words[1] in\n";
  for (const CommandInfo& command : tree)
    text += "    " + command.name + ") _arguments" + zsh_specs(command, words) + " ;;\n";
  return text +
         "  esac\n}\n"
         "# read by a start-up file, or found in $fpath\n"
         "if [[ $funcstack[1] == _gatefly ]]; then _gatefly \"$@\"; else compdef _gatefly gatefly; "
         "fi\n";
}

std::string fish_completion(const std::vector<CommandInfo>& tree, const Words& words) {
  std::string text = "# fish completion for gatefly; made by: gatefly completion fish\n";
  for (const CommandInfo& command : tree)
    text += "complete -c gatefly -f -n __fish_use_subcommand -a " + command.name + " -d '" +
            escaped(command.help, "'\\") + "'\n";
  text += "complete -c gatefly -n 'not __fish_use_subcommand' -l set -x -a " +
          quoted(files::joined(words.keys, "= ") + "=") + "\n";
  for (const CommandInfo& command : tree)
    for (const FlagInfo& flag : command.flags)
      if (!is_set(flag)) text += fish_line(command, flag, words);
  return text;
}

void declare_completion(Command& command) {
  auto options = std::make_shared<CompletionOptions>();
  command.footer(
      "Example:\n  gatefly completion bash > ~/.local/share/bash-completion/completions/gatefly\n"
      "  gatefly completion zsh > ~/.zfunc/_gatefly\n"
      "  gatefly completion fish > ~/.config/fish/completions/gatefly.fish\n\n"
      "Packages bring it along. man: the manual page, as gatefly help --man.");
  command.option("SHELL", options->shell, "for which one")
      .required()
      .one_of({"bash", "zsh", "fish", "man"});
  add_common(command, options->common);
  command.runs([options, command] { return completion(command.all(), *options); });
}

}  // namespace gatefly::cli
