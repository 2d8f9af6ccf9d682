// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "gatefly/config/random_course.hpp"
#include "gatefly/config/track_keys.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

struct NewOptions {
  CommonOptions common;
  std::string kind, file;
  std::optional<int> random;
};

constexpr const char* kHowToKeep =
    "# Every line has its default: keep those that you change. Later files and --set win.\n";

std::string content(const NewOptions& options) {
  const std::string& kind = options.kind;
  if (options.random) return config::random_course(static_cast<std::uint64_t>(*options.random));
  if (kind == "track") return config::new_track();
  if (kind == "camera")
    return "# A camera for gatefly: --camera FILE.\n" + (kHowToKeep + config::new_config("camera"));
  if (kind == "vehicle")
    return "# A vehicle for gatefly: --vehicle FILE.\n" + (kHowToKeep + config::new_vehicle());
  return "# A configuration for gatefly: --config FILE.\n" + (kHowToKeep + config::new_config());
}

/// gatefly new: a commented file to start from.
int make_new(const NewOptions& options) {
  if (options.random && options.kind != "track")
    throw std::runtime_error("new: --random = " + std::to_string(*options.random) +
                             " is for KIND = track, not " + options.kind);
  const std::string file = options.file.empty() ? options.kind + ".toml" : options.file;
  // An existing file may hold the user's own work: it is never replaced unasked.
  std::error_code error;
  if (!options.common.force && !files::is_stdout(file) && std::filesystem::exists(file, error))
    throw std::runtime_error(file + ": is there already (--force replaces it)");
  files::check_outputs(std::vector<files::Output>{{"FILE", file, {"new file", "# A"}}}, {}, true);
  files::write_file(file, content(options));
  if (files::is_stdout(file) || options.common.quiet) return kDone;
  const std::string next =
      options.kind == "track"     ? "gatefly track " + file + " checks it"
      : options.kind == "camera"  ? "gatefly detect --config " + file + " takes it"
      : options.kind == "vehicle" ? "gatefly fly --vehicle " + file + " takes it"
                                  : "gatefly fly --config " + file + " takes it";
  std::cout << file << ": written; " << next << '\n';
  return kDone;
}

}  // namespace

void declare_new(Command& command) {
  auto options = std::make_shared<NewOptions>();
  command.footer(
      "Example:\n  gatefly new track mine.toml\n  gatefly new track --random 7 course-7.toml\n  "
      "gatefly new camera -\n\n"
      "A file that is complete and can be used as it stands, each key explained.\n"
      "Exit code 0: written; 2: unusable arguments, or FILE is there already.");
  command.option("KIND", options->kind, "what to start")
      .required()
      .one_of({"track", "camera", "vehicle", "config"});
  command.option("FILE", options->file, "where to [KIND.toml]; - prints").path();
  command
      .option("--random", options->random,
              "a course drawn at random, valid in itself; the same SEED, the same course")
      .type_name("SEED")
      .between(0, std::numeric_limits<int>::max());
  command.flag("--force", options->common.force, "replace FILE when it is there");
  add_common(command, options->common);
  command.runs([options] { return make_new(*options); });
}

}  // namespace gatefly::cli
