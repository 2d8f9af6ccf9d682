// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/result_page.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/partial_folder.hpp"
#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using experiments::Experiment;
using experiments::Result;

struct ReproduceOptions {
  CommonOptions common;
  std::vector<std::string> names;
  bool list = false, all = false, quick = false, json = false;
  std::string data, out = "out/reproduce";
  std::optional<std::uint64_t> first_seed;
};

std::vector<std::string> names_of_all() {
  std::vector<std::string> names;
  for (const Experiment& experiment : experiments::all()) names.push_back(experiment.name);
  return names;
}

int print_list(bool json) {
  auto list = nlohmann::ordered_json::array();
  for (const Experiment& experiment : experiments::all()) {
    list.push_back({{"name", experiment.name}, {"what", experiment.what}});
    if (!json)
      std::cout << experiment.name
                << std::string(20 - std::min<std::size_t>(19, experiment.name.size()), ' ')
                << experiment.what << '\n';
  }
  if (json) std::cout << files::json_text(list);
  return kDone;
}

std::vector<Experiment> chosen(const ReproduceOptions& options) {
  const auto all = experiments::all();
  if (options.all) return {all.begin(), all.end()};
  const auto names = names_of_all();
  if (options.names.empty())
    throw std::runtime_error(
        "reproduce: name an experiment or --all (there are: " + files::joined(names) + ")");
  std::vector<Experiment> list;
  for (const std::string& name : options.names) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw std::runtime_error("reproduce: no experiment '" + name + "'" +
                               files::suggestion(name, names) +
                               " (there are: " + files::joined(names) + ")");
    const Experiment& experiment = all[static_cast<std::size_t>(found - names.begin())];
    if (std::none_of(list.begin(), list.end(),
                     [&](const Experiment& other) { return other.name == experiment.name; }))
      list.push_back(experiment);
  }
  return list;
}

/// A seed that would not be heeded is refused.
void check_first_seed(const std::vector<Experiment>& list, const ReproduceOptions& options) {
  if (!options.first_seed) return;
  std::vector<std::string> takers;
  for (const Experiment& experiment : experiments::all())
    if (experiment.takes_seeds) takers.push_back(experiment.name);
  for (const Experiment& experiment : list)
    if (!experiment.takes_seeds)
      throw std::runtime_error("reproduce: --first-seed " + std::to_string(*options.first_seed) +
                               ": " + experiment.name + " takes none, only " +
                               files::joined(takers) + " do");
}

/// The command that makes this result again.
std::string command_of(const Experiment& experiment, const ReproduceOptions& options) {
  return "gatefly reproduce " + experiment.name + (options.quick ? " --quick" : "") +
         (options.first_seed ? " --first-seed " + std::to_string(*options.first_seed) : "");
}

/// A letter may be several bytes of UTF-8.
std::size_t letters(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

/// `text` and blanks up to `columns` letters.
std::string padded(const std::string& text, std::size_t columns) {
  return text + std::string(columns > letters(text) ? columns - letters(text) : 0, ' ');
}

void print_table(const Experiment& experiment, const Result& result, double seconds,
                 const fs::path& folder) {
  std::size_t first = 28, second = 16;
  for (const experiments::Comparison& row : result.table)
    first = std::max(first, letters(row.what)), second = std::max(second, letters(row.paper));
  std::cout << experiment.name << ": " << experiment.what << "\n  " << padded("", first + 2)
            << padded("paper", second + 2) << "ours\n";
  for (const experiments::Comparison& row : result.table)
    std::cout << "  " << padded(row.what, first + 2) << padded(row.paper, second + 2) << row.ours
              << '\n';
  std::cout << "  " << files::text_of(seconds, 3) << " s; plot, CSV and JSON in " << folder.string()
            << '\n';
}

void write(const Result& result, files::PartialFolder& folder) {
  folder.write("result.csv", result.csv);
  folder.write("plot.png", result.picture.png());
  for (const experiments::ExtraPicture& extra : result.extra)
    folder.write(extra.name + ".png", extra.picture.png());
  folder.write("result.json", files::json_text(result.json));
  folder.pour();
}

fs::path folder_of(const Experiment& experiment, const ReproduceOptions& options) {
  return fs::path{options.out} / experiment.name;
}

/// Folder where each result will grow: taken before the work, when somebody else has one or it may
/// not be written.
std::vector<std::unique_ptr<files::PartialFolder>> taken_folders(
    const std::vector<Experiment>& list, const ReproduceOptions& options) {
  const files::OutputKind result{"earlier result", "\"quick\"", std::string::npos};
  files::check_output_folder("--out", options.out);
  std::vector<std::unique_ptr<files::PartialFolder>> folders(list.size());
  for (std::size_t i = list.size(); i-- > 0;) {  // the first made those above, and goes last
    const fs::path folder = folder_of(list[i], options);
    files::check_output_folder("--out", folder);
    if (!options.common.force)
      files::refuse_foreign_folder(folder, "result.json", result,
                                   "choose another --out (--force writes it there)");
    folders[i] = std::make_unique<files::PartialFolder>(
        folder, files::PartialFolder::Grows::kInside, [](const std::string& name) {
          return name.ends_with(".png") || name.starts_with("result.");
        });
  }
  return folders;
}

fs::path page_of(const ReproduceOptions& options) { return fs::path{options.out} / "report.html"; }

/// Writes one page of all results; none without results.
void write_page(const std::vector<experiments::PageEntry>& entries,
                const ReproduceOptions& options) {
  if (entries.empty()) return;
  files::write_file(page_of(options), experiments::result_page(entries));
  if (!options.json) std::cout << "all of it on one page: " << page_of(options).string() << '\n';
}

/// gatefly reproduce: exit 0 done, 2 unusable arguments or no data, 130 Ctrl-C.
int reproduce(const ReproduceOptions& options) {
  (void)load(options.common);  // a wrong --config or --set is an error here as everywhere
  if (options.list) return print_list(options.json);
  const std::vector<Experiment> list = chosen(options);
  check_first_seed(list, options);
  auto folders = taken_folders(list, options);
  const files::Output page{"--out", page_of(options), {"page of results", experiments::kPageMark}};
  files::check_outputs({&page, 1}, {}, options.common.force);
  std::vector<experiments::PageEntry> entries;
  catch_interrupt();
  nlohmann::ordered_json answer = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Experiment& experiment = list[i];
    Progress progress(options.common.quiet, 0.25);
    const experiments::Options told{.data = options.data,
                                    .quick = options.quick,
                                    .first_seed = options.first_seed,
                                    .progress =
                                        [&](double part, const std::string& text) {
                                          if (progress.due(part))
                                            progress.update(part, experiment.name + "  " + text);
                                        },
                                    .stopped = interrupted};
    const auto start = std::chrono::steady_clock::now();
    try {
      Result result = experiments::run(experiment, told);
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      write(result, *folders[i]);
      entries.push_back(experiments::entry_of(experiment, result, command_of(experiment, options)));
      progress.clear();
      if (!options.json) print_table(experiment, result, seconds, folder_of(experiment, options));
      answer[experiment.name] = std::move(result.json);
    } catch (const experiments::Stopped&) {
      progress.clear();
      std::cerr << "gatefly reproduce: interrupted in " << experiment.name
                << ", nothing of it kept\n";
      write_page(entries, options);
      return kInterrupted;
    }
  }
  write_page(entries, options);
  if (options.json) std::cout << files::json_text(answer);
  return kDone;
}

}  // namespace

void declare_reproduce(Command& command) {
  auto options = std::make_shared<ReproduceOptions>();
  command.footer(
      "Example:\n  gatefly reproduce roc-fitness --quick\n  gatefly reproduce --all --data ~/data "
      "--out out/reproduce\n\n"
      "Each experiment writes result.json, result.csv and plot.png into DIR/<name>/; "
      "DIR/report.html is "
      "one page of all\n"
      "that this call ran: paper, ours, command, deviation, plots. Exit code 0: done; 2: unusable "
      "arguments or no data;\n130: Ctrl-C.");
  command.option("NAME", options->names, "experiments: see --list");
  command.flag("--list", options->list, "what there is");
  command.flag("--all", options->all, "every experiment");
  command.flag("--quick", options->quick, "fewer points and repeats: seconds instead of minutes");
  command.option("--first-seed", options->first_seed,
                 "where the seeds begin [the experiment's own; see its result.json]");
  command
      .option("--data", options->data, "folder of real data [$GATEFLY_DATA, else ../shared/data]")
      .path("DIR");
  command.option("--out", options->out, "where the results go [out/reproduce]").path("DIR");
  command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return reproduce(*options); });
}

}  // namespace gatefly::cli
