// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/new_lines.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_folder.hpp"

namespace gatefly::link_sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Followed : public testing::Test {
 protected:
  void add(const std::string& text) { std::ofstream{path_, std::ios::app} << text; }
  test::TempFolder folder_;
  std::string path_ = (folder_.path() / "asks.txt").string();
};

TEST_F(Followed, AFileThatIsNotThereIsMadeAndOnlyWholeNewLinesCount) {
  NewLines lines{path_};
  EXPECT_TRUE(std::filesystem::exists(path_));
  EXPECT_THAT(lines.read(), IsEmpty());
  add("one\ntw");
  EXPECT_THAT(lines.read(), ElementsAre("one"));
  add("o\n\nthree\n");
  EXPECT_THAT(lines.read(), ElementsAre("two", "", "three"));
  EXPECT_THAT(lines.read(), IsEmpty());
}

TEST_F(Followed, WhatWasThereBeforeIsOldAndAFileBegunAnewIsNot) {
  add("arm\noverride on\n");
  NewLines lines{path_};
  EXPECT_THAT(lines.read(), IsEmpty());
  std::ofstream{path_} << "arm\n";  // another program's turn
  EXPECT_THAT(lines.read(), ElementsAre("arm"));
}

TEST_F(Followed, WhatCannotBeReadIsOneLine) {
  const std::string said = test::error_of([] { NewLines lines{"/nowhere/asks.txt"}; });
  EXPECT_THAT(said, testing::StartsWith("/nowhere/asks.txt: cannot be read: "));
}

}  // namespace
}  // namespace gatefly::link_sim
