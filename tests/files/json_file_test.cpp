// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/json_file.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/json.hpp"

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
  return test::error_of([&] { (void)json_of(text, "a.json"); });
}

TEST(Json, OfAnyDepthIsAnErrorNotACrash) {
  for (const int levels : {65, 50'000, 1'000'000}) {
    const std::string deep = "a.json: is nested more than 64 levels deep";
    EXPECT_THAT(refusal(repeated("[", levels)), HasSubstr(deep));
    EXPECT_THAT(refusal(repeated("{\"a\":", levels)), HasSubstr(deep));
    EXPECT_THAT(refusal(repeated("[", levels) + repeated("]", levels)), HasSubstr(deep));
  }
  EXPECT_EQ(json_of(repeated("[", 64) + repeated("]", 64), "a.json").size(), 1u);
}

TEST(Json, OfTooManyValuesIsAnError) {
  EXPECT_THAT(refusal("[" + repeated("0,", 2'000'000) + "0]"),
              HasSubstr("holds more than 2000000 values"));
}

TEST(Json, OfManyObjectsOrMembersIsReadOrRefusedAtOnce) {
  EXPECT_EQ(json_of("[" + repeated("{},", 300'000) + "{}]", "a.json").size(), 300'001u);
  std::string members;
  for (int i = 0; i < 200'000; ++i) members += "\"" + std::to_string(i) + "\":0,";
  EXPECT_THAT(refusal("{" + members + "\"x\":0}"),
              HasSubstr("an object of more than 10000 members"));
}

TEST(Json, ThatIsDamagedSaysWhere) {
  EXPECT_THAT(refusal(""),
              HasSubstr("a.json: is damaged, not valid JSON from line 1 on, where it ends early"));
  EXPECT_THAT(refusal("{\n\"a\": 1,\n\"b\": }"), HasSubstr("from line 3 on"));
  EXPECT_THAT(refusal("{\"a\": \"\xff\"}"), HasSubstr("is damaged"));
  EXPECT_THAT(refusal("[\n1e999]"), HasSubstr("from line 2 on"));
}

TEST(ReadJson, OfAFolderIsAnError) {
  const test::TempFolder folder;
  EXPECT_THAT(test::error_of([&] { (void)read_json(folder.path()); }),
              HasSubstr("is no regular file"));
  EXPECT_THAT(test::error_of([&] { (void)read_json(folder.path() / "none"); }),
              HasSubstr("cannot be read"));
}

class Members : public testing::Test {
 protected:
  template <class Read>
  std::string refused(Read read) {
    return test::error_of([&] { (void)read(object_); });
  }
  nlohmann::ordered_json json_ = json_of(
      R"({"n": 3, "x": -0.5, "t": "text", "yes": true, "none": null, "list": [1, null], "in": {"deep": "many"}})",
      "run.json");
  JsonObject object_{"run.json", json_};
};

TEST_F(Members, OfTheTypeThatIsAskedForAreGiven) {
  EXPECT_EQ(object_.count("n"), 3);
  EXPECT_EQ(object_.whole("n", 3, 3), 3u);
  EXPECT_EQ(object_.number("x"), -0.5);
  EXPECT_EQ(object_.text("t"), "text");
  EXPECT_EQ(object_.text("none", "fallback"), "fallback");
  EXPECT_TRUE(object_.truth("yes"));
  EXPECT_FALSE(object_.has("none"));
  EXPECT_TRUE(std::isnan(object_.number_or_null("none")));
  EXPECT_TRUE(std::isnan(object_.numbers_or_null("list", 2)[1]));
  EXPECT_EQ(object_.object("in").text("deep"), "many");
}

TEST_F(Members, OfAnotherTypeAreOneLineWithFileAndKey) {
  EXPECT_EQ(refused([](const auto& o) { return o.object("in").count("deep"); }),
            "run.json: in.deep = \"many\", must be a whole number, in 0..1000000000");
  EXPECT_EQ(refused([](const auto& o) { return o.count("x"); }),
            "run.json: x = -0.5, must be a whole number, in 0..1000000000");
  EXPECT_EQ(refused([](const auto& o) { return o.whole("n", 4, 9); }),
            "run.json: n = 3, must be a whole number, in 4..9");
  EXPECT_EQ(refused([](const auto& o) { return o.text("gone"); }),
            "run.json: gone is missing, must be text");
  EXPECT_EQ(refused([](const auto& o) { return o.number("t"); }),
            "run.json: t = \"text\", must be a number");
  EXPECT_EQ(refused([](const auto& o) { return o.number("none"); }),
            "run.json: none is missing, must be a number");
  EXPECT_EQ(refused([](const auto& o) { return o.number_or_null("gone"); }),
            "run.json: gone is missing, must be a number or null");
  EXPECT_EQ(refused([](const auto& o) { return o.truth("n"); }),
            "run.json: n = 3, must be true or false");
  EXPECT_EQ(refused([](const auto& o) { return o.object("list"); }),
            "run.json: list = [1, null], must be an object");
  EXPECT_EQ(refused([](const auto& o) { return o.wholes("list", 2, 0, 9); }),
            "run.json: list = [1, null], must be a list of 2 whole numbers, in 0..9");
}

TEST(Object, MustBeOne) {
  const nlohmann::ordered_json list = {1, 2};
  EXPECT_EQ(test::error_of([&] { (void)JsonObject("run.json", list); }),
            "run.json: is [1, 2], must be an object");
}

TEST(Shown, IsShortWhateverTheValue) {
  nlohmann::json big = nlohmann::json::array();
  for (int i = 0; i < 1'000'000; ++i) big.push_back(i);
  EXPECT_LE(shown(big).size(), 200u);
  EXPECT_LE(shown(nlohmann::json(std::string(10'000'000, 'x'))).size(), 60u);
  EXPECT_LE(shown(nlohmann::json{{"key", big}}).size(), 60u);
  EXPECT_EQ(shown(nlohmann::json{{"a", {1, 2.5}}}), "{\"a\":[1, 2.5]}");
  EXPECT_EQ(shown(nlohmann::json(nullptr)), "nothing");
}

TEST(JsonText, TakesNamesThatAreNoUtf8) {
  EXPECT_THAT(json_text(nlohmann::json{{"name", "a\xff"}}), HasSubstr("a\xef\xbf\xbd"));
}

}  // namespace
}  // namespace gatefly::files
