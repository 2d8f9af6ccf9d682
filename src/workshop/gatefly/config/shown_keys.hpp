// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/config/config.hpp"

namespace gatefly::config {

/// A key as `gatefly config` tells it.
struct ShownKey {
  std::string name;      ///< "section.key".
  nlohmann::json value;  ///< Null: the track's, nothing in the configuration sets it.
  std::string unit;      ///< "" when it has none.
  std::string what;      ///< In a few words.
  std::string allowed;   ///< "a number in 0..1".
  std::string source;    ///< "default: ..." or "set by ...".
};

/// Every key, in the order of config --show.
[[nodiscard]] std::vector<ShownKey> shown_keys(const Config& config);

/// The key of that name. @throws std::runtime_error naming what may have been meant.
[[nodiscard]] ShownKey shown_key(const Config& config, const std::string& name);

/// Whether the key's name, unit or explanation holds `text`, in small letters or capitals.
[[nodiscard]] bool is_about(const ShownKey& key, std::string_view text);

/// A value as a configuration file has it: whole, with every digit.
[[nodiscard]] std::string written(const nlohmann::json& value);

/// The keys as a configuration file, one line each under their [sections]; the track's are comments.
[[nodiscard]] std::string as_file(const std::vector<ShownKey>& keys);

}  // namespace gatefly::config
