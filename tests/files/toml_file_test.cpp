// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/toml_file.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

using testing::HasSubstr;

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

std::string refusal(const std::string& text) {
  return test::error_of([&] { (void)TomlFile("a.toml", text); });
}

TEST(Toml, OfAnyDepthIsAnErrorNotACrash) {
  const std::string deep = "is nested more than 16 levels deep";
  for (const int levels : {17, 20'000, 200'000}) {
    EXPECT_THAT(refusal("x = 1\n" + repeated("a.", levels) + "a = 1"),
                HasSubstr("a.toml:2: " + deep));
    EXPECT_THAT(refusal(repeated("\"a\" . ", levels) + "a = 1"), HasSubstr(deep));
    EXPECT_THAT(refusal("[" + repeated("a.", levels) + "a]"), HasSubstr(deep));
    EXPECT_THAT(refusal("a = " + repeated("[", levels)), HasSubstr(deep));
    EXPECT_THAT(refusal("a = " + repeated("[\n", levels)), HasSubstr(deep));
    EXPECT_THAT(refusal("a = " + repeated("{a=", levels)), HasSubstr(deep));
    EXPECT_THAT(refusal("a = " + repeated("{a.a.a=", levels)), HasSubstr(deep));
    EXPECT_EQ(parse_toml_value(repeated("[", levels)), repeated("[", levels));
    EXPECT_EQ(parse_toml_value("1\n" + repeated("a.", levels) + "a = 1"),
              "1\n" + repeated("a.", levels) + "a = 1");
  }
}

TEST(Toml, TextsAndCommentsAreNotNested) {
  const std::string many = repeated("[{a.", 100);
  const TomlFile file("a.toml", "# " + many + "\na = '" + many + "'\nb = \"\\\"" + many +
                                    "\"\nc = \"\"\"\n" + many + "\n\\\"\"\"\"\"\"\nd = '''" + many +
                                    "'''''\n'" + many + "' = [0.1, 0.2, 1.5]\n");
  EXPECT_EQ(file.content().size(), 5u);
  EXPECT_EQ(file.content().at("a"), many);
  EXPECT_EQ(file.content().at("d"), many + "''");
  EXPECT_EQ(file.content().at(many).size(), 3u);
}

TEST(Toml, ALongFileIsRefusedUnread) {
  const test::TempFolder folder;
  const auto path = folder.file("a.toml", "a = [" + repeated("0,", 8'000'000) + "]");
  EXPECT_THAT(test::error_of([&] { (void)TomlFile(path); }), HasSubstr("is longer than 1 MiB"));
}

TEST(Toml, LongKeysInLongFilesTakeNoMemoryEach) {
  const std::string key(500'000, 'k');
  const TomlFile file("a.toml", "[" + key + "]\na = [" + repeated("{b=0},", 60'000) + "]");
  EXPECT_EQ(file.content().at(key).at("a").size(), 60'000u);
  EXPECT_EQ(file.place("/" + key + "/a"), "a.toml");
}

}  // namespace
}  // namespace gatefly::files
