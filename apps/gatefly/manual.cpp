// SPDX-License-Identifier: Apache-2.0
#include <sstream>
#include <string_view>

#include "command_tree.hpp"

namespace gatefly::cli {
namespace {

/// A line of text as roff takes it, whatever it begins with.
std::string plain(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (i == 0 && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else if (text.compare(i, 2, "\xC2\xB0") == 0) {
      result += "\\(de", ++i;
    } else {
      result += c;
    }
  }
  return result;
}

/// The same in lines that are not too long to be looked at.
std::string paragraph(const std::string& text) {
  constexpr std::size_t kLongest = 72;
  std::istringstream words{text};
  std::string result, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + word.size() >= kLongest) {
      result += plain(line) + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return result + plain(line) + "\n";
}

/// Examples and exit codes, line by line; a blank line begins a paragraph.
std::string literal(const std::string& text) {
  std::istringstream lines{text};
  std::string result = ".Bd -literal\n";
  for (std::string line; std::getline(lines, line);) result += plain(line) + "\n";
  return result + ".Ed\n";
}

std::string item(const FlagInfo& flag) {
  std::string line = ".It";
  for (std::size_t i = 0; i < flag.names.size(); ++i)
    line += (i > 0 ? " , " : " ") + ("Fl " + plain(flag.names[i].substr(1)));
  if (!flag.value.empty()) line += " Ar " + plain(flag.value);
  if (flag.repeated) line += " ...";
  std::string text = flag.help;
  if (!flag.choices.empty()) {
    text += text.empty() ? "One of" : "; one of";
    for (std::size_t i = 0; i < flag.choices.size(); ++i)
      text += (i > 0 ? ", " : " ") + flag.choices[i];
  }
  return line + "\n" + paragraph(text + (flag.required ? "; must be given." : "."));
}

std::string section(const CommandInfo& command) {
  std::string text = ".Ss gatefly " + command.name + "\n" + paragraph(command.help + ".");
  text += ".Bl -tag -width Ds\n";
  for (const FlagInfo& flag : command.flags) text += item(flag);
  text += ".El\n";
  return command.footer.empty() ? text : text + literal(command.footer);
}

}  // namespace

std::string manual_page(const std::vector<CommandInfo>& tree) {
  std::string text =
      ".\\\" made by: gatefly help --man\n"
      ".Dd " GATEFLY_DATE
      "\n.Dt GATEFLY 1\n.Os\n.Sh NAME\n.Nm gatefly\n.Nd flies a drone through gates with one "
      "camera, an IMU and a "
      "sonar\n"
      ".Sh SYNOPSIS\n.Nm\n.Ar COMMAND\n.Op Ar ...\n.Nm\n.Cm help\n.Op Ar COMMAND\n.Nm\n.Fl V\n"
      ".Sh DESCRIPTION\n"
      "A simulator with a rendered camera, replay of recorded flights, and one\n"
      "pilot for both; gates in pictures, cameras calibrated, colours tuned, and\n"
      "the experiments of a paper reproduced.\n"
      "Without arguments it prints its help.\n"
      "This is version " GATEFLY_VERSION ".\n";
  for (const CommandInfo& command : tree) text += section(command);
  return text +
         ".Sh ENVIRONMENT\n.Bl -tag -width Ds\n"
         ".It Ev GATEFLY_DATA\nFolder of recorded flights and pictures; else ../shared/data.\n"
         ".It Ev XDG_CACHE_HOME\nLight maps of rooms are kept in its folder gatefly; else in "
         "~/.cache.\n"
         ".It Ev XDG_DATA_DIRS\nWhere share/gatefly is looked for when it is not above the "
         "program.\n"
         ".It Ev NO_COLOR\nNo colour, also on a terminal.\n"
         ".It Ev COLUMNS\nWidth of the progress line where the terminal does not tell its own.\n"
         ".El\n.Sh FILES\n.Bl -tag -width Ds\n"
         ".It Pa share/gatefly\nTracks, configurations, cameras and vehicles that gatefly comes "
         "with.\n"
         ".It Pa out\nWhere flights, campaigns and experiments go unless told otherwise.\n"
         ".El\n.Sh EXIT STATUS\n.Bl -tag -width Ds\n"
         ".It 0\nThe work is done.\n"
         ".It 1\nIt ran, and the answer is no: a race not finished, no gate found.\n"
         ".It 2\nArguments or a file cannot be used; one line on standard error says why.\n"
         ".It 130\nInterrupted by Ctrl\\-C (143: SIGTERM, 129: SIGHUP).\n"
         ".El\n.Sh EXAMPLES\n"
         ".Dl gatefly fly showroom \\-\\-seed 7\n"
         ".Dl gatefly detect photo.jpg \\-\\-csv found.csv\n";
}

}  // namespace gatefly::cli
