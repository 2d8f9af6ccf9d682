// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/color_model_file.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/config/config.hpp"
#include "gatefly/geometry/rng.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Values as a fit makes them, whole eighths of a nat.
ColorModel fitted(std::uint64_t seed) {
  Rng rng{seed};
  ColorModel model;
  for (auto* table : {&model.absolute, &model.relative})
    for (auto& value : *table)
      value = static_cast<std::int8_t>(2 * std::floor(rng.uniform(-32, 32)));
  return model;
}

TEST(ColorModelFile, ReadsBackWhatAFitMakes) {
  const test::TempFolder folder;
  const ColorModel model = fitted(1);
  const ColorModel again = read_color_model(
      folder.file("colors.toml", color_model_text(model, "two \"pictures\"\nof a gate")));
  EXPECT_EQ(again.absolute, model.absolute);
  EXPECT_EQ(again.relative, model.relative);
}

TEST(ColorModelFile, RoundsOtherValuesToAnEighthOfANat) {
  const test::TempFolder folder;
  const ColorModel model = ColorModel::described({1.0, 0.4, 0.0});
  const ColorModel again =
      read_color_model(folder.file("colors.toml", color_model_text(model, "")));
  for (std::size_t i = 0; i < ColorModel::kBins; ++i) {
    ASSERT_LE(std::abs(again.absolute[i] - model.absolute[i]), 1) << i;
    ASSERT_LE(std::abs(again.relative[i] - model.relative[i]), 1) << i;
  }
}

TEST(ColorModelFile, StaysSmall) { EXPECT_LT(color_model_text(fitted(2), "").size(), 40'000u); }

TEST(ColorModelFile, EveryDefectIsOneLineWithFileAndKey) {
  const test::TempFolder folder;
  const std::string whole = color_model_text(fitted(3), "");
  const auto error_of = [&](const std::string& content) {
    return test::error_of([&] { (void)read_color_model(folder.file("colors.toml", content)); });
  };
  const auto replaced = [&](const std::string& what, const std::string& by) {
    std::string content = whole;
    return content.replace(content.find(what), what.size(), by);
  };
  EXPECT_THAT(error_of(""), AllOf(HasSubstr("colors.toml"), HasSubstr("version")));
  EXPECT_THAT(error_of("[color]\nrgb = [1, 0, 0]\n"), HasSubstr("not a colour table"));
  EXPECT_THAT(error_of(replaced("version = 1", "version = 2")),
              HasSubstr("version = 2, must be 1"));
  EXPECT_THAT(error_of(replaced("absolute", "absolut")),
              AllOf(HasSubstr("absolute"), HasSubstr("missing")));
  EXPECT_THAT(error_of(replaced("about = \"\"", "about = \"\"\nother = 1")),
              HasSubstr("other is not a known key"));
  EXPECT_THAT(error_of(replaced("relative = [\n  \"", "relative = [\n  \"A")),
              AllOf(HasSubstr("relative[0]"), HasSubstr("1025"), HasSubstr("1024")));
  EXPECT_THAT(error_of(replaced("absolute = [\n", "absolute = [ 7,\n")), HasSubstr("absolute"));
  std::string star = whole;
  star[whole.find("relative = [\n  \"") + 20] = '*';
  EXPECT_THAT(error_of(star), HasSubstr("relative[0]"));
  for (const std::size_t part : {whole.size() / 3, whole.size() / 2, whole.size() - 5})
    EXPECT_THAT(error_of(whole.substr(0, part)),
                AllOf(HasSubstr("colors.toml"), Not(HasSubstr("\n"))))
        << part;
  EXPECT_THAT(test::error_of([&] { (void)read_color_model(folder.path() / "none.toml"); }),
              HasSubstr("none.toml"));
}

TEST(ColorTable, IsLookedForBesideTheFileThatNamesItAndTakesThePlaceOfTheDescription) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder.path() / "tables");
  const ColorModel model = fitted(4);
  (void)folder.file("tables/mine.toml", color_model_text(model, ""));
  const std::vector<std::filesystem::path> files{
      folder.file("my.toml", "[color]\ntable = \"tables/mine.toml\"\n")};
  EXPECT_EQ(config::load_config(files).pilot.gate_color.absolute, model.absolute);
  EXPECT_EQ(config::load_config(files, std::vector<std::string>{"color.table=\"\""})
                .pilot.gate_color.absolute,
            config::Config{}.pilot.gate_color.absolute);
}

TEST(ColorTable, ThatIsNotThereIsSaidWithTheFileThatNamesIt) {
  const test::TempFolder folder;
  const std::vector<std::filesystem::path> files{
      folder.file("my.toml", "[color]\ntable = \"none.toml\"\n")};
  const std::string error = test::error_of([&] { (void)config::load_config(files); });
  EXPECT_THAT(error, AllOf(HasSubstr("my.toml:2: color.table: "), HasSubstr("none.toml"),
                           Not(HasSubstr("\n"))));
  const std::string wrong = test::error_of(
      [&] { (void)config::load_config({}, std::vector<std::string>{"color.table=3"}); });
  EXPECT_THAT(wrong, HasSubstr("color.table = 3, must be the name of a file"));
}

}  // namespace
}  // namespace gatefly::files
