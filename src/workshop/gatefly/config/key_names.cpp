// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/key_names.hpp"

#include <cstddef>

#include "gatefly/config/config.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::config {
namespace {

/// "'a' or 'b'".
std::string quoted(const std::vector<std::string>& keys) {
  return "'" + files::joined(keys, "' or '") + "'";
}

}  // namespace

std::vector<std::string> key_names() {
  std::vector<std::string> names{"randomize.level"};
  for (const auto& key : config_keys()) names.push_back(key.rule.name);
  for (const auto& key : randomize_keys()) names.push_back(key.rule.name);
  for (const auto& key : fault_keys()) names.push_back(key.rule.name);
  return names;
}

std::string key_suggestion(const std::string& name) {
  constexpr std::size_t kLongest = 100;  // nobody meant one of ours by a longer one
  if (name.size() > kLongest) return ", gatefly config --show lists them all";
  const auto section = name.substr(0, name.find('.') + 1);  // "" when there is none
  const std::string last = name.substr(section.size());
  std::vector<std::string> same, longer_here, longer, beside;
  for (const std::string& key : key_names()) {
    const std::string end = key.substr(key.find('.') + 1);
    const bool is_here = !section.empty() && key.starts_with(section);
    if (end == last) same.push_back(key);
    if (is_here) beside.push_back(end);
    if (!last.empty() && end.starts_with(last + "_"))
      (is_here ? longer_here : longer).push_back(key);
  }
  constexpr std::size_t kFew = 3;
  for (const auto& meant : {same, longer_here, longer})
    if (!meant.empty() && meant.size() <= kFew) return ", did you mean " + quoted(meant) + "?";
  if (!files::suggestion(last, beside).empty())
    return ", did you mean '" + section + files::nearest(last, beside) + "'?";
  const std::string any = beside.empty() ? files::suggestion(name, key_names()) : "";
  return any.empty() ? ", gatefly config --show lists them all" : any;
}

}  // namespace gatefly::config
