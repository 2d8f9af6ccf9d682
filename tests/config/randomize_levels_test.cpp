// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/config/randomize_keys.hpp"

namespace gatefly::config {
namespace {

const std::vector<std::string> kLevels{"none", "race", "hard"};

/// The table of docs/simulation.md, "What a seed changes": key -> cells under none, race, hard.
std::map<std::string, std::vector<std::string>> documented_levels() {
  std::ifstream page{std::string{std::getenv("GATEFLY_SOURCE_DIR")} + "/docs/simulation.md"};
  std::map<std::string, std::vector<std::string>> levels;
  bool in_table = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| quantity | `none` | `race` | `hard` | key |")) in_table = true;
    if (!in_table || line.starts_with("| ---")) continue;
    if (!line.starts_with("|")) break;
    std::vector<std::string> cells;
    std::istringstream row{line.substr(1)};
    for (std::string cell; std::getline(row, cell, '|');) {
      const auto from = cell.find_first_not_of(' '), to = cell.find_last_not_of(' ');
      cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
    }
    if (cells.size() != 5 || cells[4] == "key") continue;
    levels[cells[4].substr(1, cells[4].size() - 2)] = {cells[1], cells[2], cells[3]};
  }
  return levels;
}

TEST(RandomizeLevels, AreWhatTheSimulatorsPageSays) {
  const auto documented = documented_levels();
  for (std::size_t level = 0; level < kLevels.size(); ++level) {
    const world::Randomize sizes = world::randomize_level(kLevels[level]);
    for (const auto& key : randomize_keys()) {
      const std::string name = key.rule.name.substr(std::string{"randomize."}.size());
      ASSERT_TRUE(documented.contains(name)) << name;
      // The number before the unit, which is the key's; words ("fixed, above") mean no draw.
      const double said = std::strtod(documented.at(name)[level].c_str(), nullptr);
      EXPECT_DOUBLE_EQ(key.get(sizes).get<double>(), said) << kLevels[level] << ' ' << name;
    }
  }
  EXPECT_EQ(documented.size(), randomize_keys().size());
}

}  // namespace
}  // namespace gatefly::config
