// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/csv.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Csv, ReadsColumnsByName) {
  const test::TempFolder folder;
  const Csv csv(folder.file("a.csv", "t_s,name,x_m\n0.5,a,1e-3\n1.5,b,\n"));
  EXPECT_EQ(csv.rows(), 2u);
  EXPECT_THAT(csv.numbers("t_s"), ElementsAre(0.5, 1.5));
  EXPECT_THAT(csv.texts("name"), ElementsAre("a", "b"));
  EXPECT_TRUE(std::isnan(csv.numbers("x_m")[1]));  // an empty cell
  EXPECT_FALSE(csv.has("y_m"));
}

TEST(Csv, WindowsLineEndsAndAMissingLastOneAreFine) {
  const test::TempFolder folder;
  const Csv csv(folder.file("a.csv", "a,b\r\n1,2\r\n3,4"));
  EXPECT_THAT(csv.numbers("b"), ElementsAre(2, 4));
}

TEST(Csv, ReadsWhatSpreadsheetsWrite) {
  const test::TempFolder folder;
  for (const char* content :
       {"\xEF\xBB\xBFimage,x\na,0.5\n", "image;x\r\na;0,5\r\n", "image,x\ra,0.5\r",
        "image\tx\na\t0.5\n", "\"image\", \"x\"\n\"a\",0.5\n"}) {
    const Csv csv(folder.file("a.csv", content));
    EXPECT_THAT(csv.texts("image"), ElementsAre("a")) << content;
    EXPECT_THAT(csv.numbers("x"), ElementsAre(0.5)) << content;
  }
}

TEST(Csv, ErrorsNameFileLineAndColumn) {
  const test::TempFolder folder;
  const auto error = [&](const std::string& content, const char* column) {
    return test::error_of([&] { (void)Csv(folder.file("a.csv", content)).numbers(column); });
  };
  EXPECT_THAT(error("a,b\n1,2\n1,x2\n", "b"), HasSubstr("a.csv:3:2: b = 'x2', must be a number"));
  EXPECT_EQ(error("a,b\n1, 2 \n", "b"), "");  // as blackbox_decode writes them
  EXPECT_THAT(error("a,b\n1,2 3\n", "b"), HasSubstr("a.csv:2:2"));
  EXPECT_THAT(error("a,b\n1,nan\n", "b"), HasSubstr("a.csv:2:2"));
  EXPECT_THAT(error("a,b\n1,inf\n", "b"), HasSubstr("a.csv:2:2"));
  EXPECT_THAT(error("a,b\n1\n", "b"), HasSubstr("a.csv:2: has 1 cells, must have 2"));
  EXPECT_THAT(error("a,b\n1,2,3\n", "b"), HasSubstr("a.csv:2: has 3 cells"));
  EXPECT_THAT(error("a,b\n1,2\n\n", "b"), HasSubstr("a.csv:3: has 1 cells"));
  EXPECT_THAT(error("t_s,b\n1,2\n", "t_ms"),
              HasSubstr("a.csv:1: has no column 't_ms' (there are: t_s, b)"));
  EXPECT_THAT(error(std::string{"a,b\n1,\0002\n", 9}, "b"), HasSubstr("a.csv: is no text"));
  EXPECT_THAT(error("\xFF\xFEt\0_\0s\0", "t_s"), HasSubstr("a.csv: is UTF-16 text"));
  EXPECT_THAT(error("a,a\n1,2\n", "a"), HasSubstr("same name"));
  EXPECT_THAT(error("", "a"), HasSubstr("a.csv:1"));
}

TEST(Csv, OfAThousandColumnsAndMoreIsRefusedUnread) {
  const test::TempFolder folder;
  std::string content(10'000'000, ',');
  content += '\n';
  EXPECT_THAT(test::error_of([&] { (void)Csv(folder.file("a.csv", content)); }),
              HasSubstr("a.csv:1: has more than 1000 columns"));
}

}  // namespace
}  // namespace gatefly::files
