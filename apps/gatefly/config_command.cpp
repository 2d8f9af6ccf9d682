// SPDX-License-Identifier: Apache-2.0
#include <iomanip>
#include <iostream>
#include <memory>
#include <vector>

#include "gatefly/config/json_schema.hpp"
#include "gatefly/config/shown_keys.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

struct ConfigOptions {
  CommonOptions common;
  std::string key, filter;
  bool show = false, json = false, schema = false;
};

nlohmann::ordered_json as_json(const config::ShownKey& key) {
  return {{"key", key.name},  {"value", key.value},     {"unit", key.unit},
          {"what", key.what}, {"allowed", key.allowed}, {"source", key.source}};
}

/// gatefly config KEY: one key, all that is known of it.
int one_key(const config::ShownKey& key, const ConfigOptions& options) {
  if (options.json) {
    std::cout << as_json(key).dump(2) << '\n';
    return kDone;
  }
  const bool by_track = key.value.is_null();
  std::cout << key.name << " = " << (by_track ? "the track's" : config::written(key.value)) << '\n';
  if (options.common.quiet) return kDone;
  const auto line = [](const char* name, const std::string& text) {
    if (!text.empty()) std::cout << "  " << std::left << std::setw(9) << name << text << '\n';
  };
  line("unit", key.unit);
  line("what", key.what);
  line("allowed", key.allowed);
  line("source", key.source);
  return kDone;
}

/// gatefly config --filter: the keys that are about something, as a configuration file.
int filtered(const config::Config& config, const ConfigOptions& options) {
  std::vector<config::ShownKey> keys = config::shown_keys(config);
  std::erase_if(
      keys, [&](const config::ShownKey& key) { return !config::is_about(key, options.filter); });
  if (options.json) {
    auto list = nlohmann::ordered_json::array();
    for (const config::ShownKey& key : keys) list.push_back(as_json(key));
    std::cout << list.dump(2) << '\n';
  } else {
    std::cout << config::as_file(keys);
  }
  if (keys.empty())
    std::cerr << "gatefly config: no key is about '" << files::one_line(options.filter) << "'\n";
  return keys.empty() ? kAnswerIsNo : kDone;
}

/// gatefly config: every key, its value, unit, and who set it.
int config(const ConfigOptions& options) {
  if (options.schema) {
    std::cout << files::json_text(config::config_schema());
    return kDone;
  }
  const config::Config config = load(options.common);
  if (!options.key.empty()) return one_key(config::shown_key(config, options.key), options);
  if (!options.filter.empty()) return filtered(config, options);
  if (options.json) {
    std::cout << files::json_text(config::as_json(config));
  } else {
    std::cout << config::show(config);
  }
  return kDone;
}

}  // namespace

void declare_config(Command& command) {
  auto options = std::make_shared<ConfigOptions>();
  command.footer(
      "Example:\n  gatefly config --show --config cameras/bebop.toml --set control.speed_mps=1.5\n"
      "  gatefly config control.speed_mps\n  gatefly config --filter wind\n\n"
      "Exit code 0: printed; 1: --filter found nothing; 2: unusable arguments or files.");
  const Flag key = command.option("KEY", options->key,
                                  "one key, e.g. camera.tilt_deg: value, unit, what is allowed, "
                                  "where it comes from");
  command
      .option("--filter", options->filter,
              "only keys whose name, unit or explanation has this text")
      .excludes(key);
  command.flag("--show", options->show, "print the effective configuration (what it does anyway)");
  command.flag("--json", options->json, "the values as JSON");
  command.flag("--schema", options->schema,
               "print a JSON schema of configuration files, for editors");
  add_common(command, options->common);
  command.runs([options] { return config(*options); });
}

}  // namespace gatefly::cli
