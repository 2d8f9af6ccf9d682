// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/shown_keys.hpp"

#include <algorithm>
#include <cctype>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "gatefly/config/allowed_values.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/key_names.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::config {
namespace {

using nlohmann::json;

ShownKey shown_as(const Config& config, const KeyRule& rule, json value,
                  const std::string& default_source) {
  const auto set_by = config.set_by.find(rule.name);
  return {.name = rule.name,
          .value = std::move(value),
          .unit = unit_of(rule.name),
          .what = rule.what,
          .allowed = allowed_values(rule),
          .source = set_by == config.set_by.end() ? "default: " + default_source
                                                  : "set by " + set_by->second};
}

std::string small(std::string_view text) {
  std::string letters;
  for (const char c : text)
    letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

}  // namespace

std::vector<ShownKey> shown_keys(const Config& config) {
  std::vector<ShownKey> keys;
  for (const auto& key : config_keys())
    keys.push_back(shown_as(config, key.rule, key.get(config), key.rule.source));
  const auto over_the_track = [&](const KeyRule& rule, const json& over) {
    const std::string key = rule.name.substr(rule.name.find('.') + 1);
    keys.push_back(shown_as(config, rule, over.contains(key) ? over[key] : json{},
                            over.contains(key) ? "" : "the track file's"));
  };
  over_the_track(randomize_level_rule(), config.randomize);
  for (const auto& key : randomize_keys()) over_the_track(key.rule, config.randomize);
  for (const auto& key : fault_keys()) over_the_track(key.rule, config.faults);
  return keys;
}

ShownKey shown_key(const Config& config, const std::string& name) {
  const std::vector<ShownKey> keys = shown_keys(config);
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const ShownKey& key) { return key.name == name; });
  if (found == keys.end())
    throw std::runtime_error("config " + files::one_line(name) + ": is not a known key" +
                             key_suggestion(name));
  return *found;
}

bool is_about(const ShownKey& key, std::string_view text) {
  return small(key.name + " " + key.unit + " " + key.what).find(small(text)) != std::string::npos;
}

std::string written(const json& value) {
  if (value.is_number_float()) return files::text_of(value.get<double>());
  if (value.is_array()) {
    std::vector<std::string> items;
    for (const json& item : value) items.push_back(written(item));
    return "[" + files::joined(items) + "]";
  }
  return value.is_string() ? value.dump(-1, ' ', false, json::error_handler_t::replace)
                           : files::shown(value);
}

std::string as_file(const std::vector<ShownKey>& keys) {
  std::ostringstream text;
  std::string section;
  for (const ShownKey& key : keys) {
    const auto dot = key.name.find('.');
    if (key.name.substr(0, dot) != section)
      text << (section.empty() ? "" : "\n") << '[' << (section = key.name.substr(0, dot)) << "]\n";
    const bool by_track = key.value.is_null();
    text << std::left << std::setw(28) << (by_track ? "# " : "") + key.name.substr(dot + 1) << " = "
         << std::setw(22) << (by_track ? "\"track's\"" : written(key.value)) << "  # "
         << (key.unit.empty() ? "" : key.unit + ", ") << key.what << "; " << key.source << '\n';
  }
  return text.str();
}

std::string show(const Config& config) { return as_file(shown_keys(config)); }

}  // namespace gatefly::config
