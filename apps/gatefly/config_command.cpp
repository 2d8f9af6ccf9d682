// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "gatefly/config/json_schema.hpp"
#include "gatefly/files/json.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

struct ConfigOptions {
  CommonOptions common;
  bool show = false, json = false, schema = false;
};

/// gatefly config: every key, its value, unit, and who set it.
int config(const ConfigOptions& options) {
  if (options.schema) {
    std::cout << io::json_text(io::config_schema());
    return kDone;
  }
  const io::Config config = load(options.common);
  if (options.json) {
    std::cout << io::json_text(io::as_json(config));
  } else {
    std::cout << io::show(config);
  }
  return kDone;
}

}  // namespace

void declare_config(Command& command) {
  auto options = std::make_shared<ConfigOptions>();
  command.footer(
      "Example:\n  gatefly config --show --config cameras/bebop.toml --set control.speed_mps=1.5");
  command.flag("--show", options->show, "print the effective configuration (what it does anyway)");
  command.flag("--json", options->json, "the values as JSON");
  command.flag("--schema", options->schema,
               "print a JSON schema of configuration files, for editors");
  add_common(command, options->common);
  command.runs([options] { return config(*options); });
}

}  // namespace gatefly::cli
