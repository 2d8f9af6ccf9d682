// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/result_page.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Result result_with(const std::string& what) {
  Result result{.table = {{what, "1 m", "2 m"}, {"  of it", "-", "0.5"}},
                .json = nlohmann::ordered_json::object(),
                .csv = "",
                .picture = drawing::Canvas(40, 30)};
  result.json["quick"] = true;
  return result;
}

Result none(const Options& /*options*/) { return result_with(""); }

PageEntry entry(const std::string& name, const std::string& what) {
  return entry_of({.name = name,
                   .what = "about " + name,
                   .run = none,
                   .deviations = {{"eq-22", "PD on the line"}}},
                  result_with(what), "gatefly reproduce " + name);
}

int count(const std::string& text, const std::string& part) {
  int times = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++times;
  return times;
}

TEST(ResultPage, TellsPaperOursCommandAndDeviationOfEveryExperiment) {
  const std::vector<PageEntry> entries{entry("first", "error"), entry("second", "speed")};
  const std::string html = result_page(entries);
  for (const char* part : {"<section id=\"first\">", "<section id=\"second\">", "href=\"#second\"",
                           ">error<", ">speed<", ">1 m<", ">2 m<", "gatefly reproduce second",
                           "PD on the line", "deviations.md#eq-22", kPageMark})
    EXPECT_THAT(html, HasSubstr(part));
  EXPECT_EQ(count(html, "data:image/"), 2);
  EXPECT_EQ(count(html, "<tr"), 2 * 3);
}

TEST(ResultPage, NeedsNoNetworkAndNoScript) {
  const std::string html = result_page(std::vector{entry("first", "error")});
  for (const char* part :
       {"http:", "https:", "src=\"//", "href=\"//", "<script", "@import", "url("})
    EXPECT_THAT(html, Not(HasSubstr(part)));
  for (std::size_t at = html.find("src=\""); at != std::string::npos;
       at = html.find("src=\"", at + 1))
    EXPECT_EQ(html.substr(at + 5, 11), "data:image/");
}

TEST(ResultPage, TextIsTextWhateverIsInIt) {
  const std::string html = result_page(std::vector{entry("first", "<b>\"a\" & 'b'</b>")});
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/b&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<b>")));
}

TEST(ResultPage, QuickRunsAreMarkedAndOthersAreNot) {
  PageEntry slow = entry("slow", "error");
  slow.quick = false;
  EXPECT_THAT(result_page(std::vector{slow}), Not(HasSubstr("quick run</span>")));
  const std::string both = result_page(std::vector{slow, entry("fast", "error")});
  EXPECT_EQ(count(both, "quick run</span>"), 1);
  EXPECT_THAT(both, HasSubstr("fewer points and repeats"));
}

TEST(ResultPage, PicturesThatAreTooLargeAreNamed) {
  PageEntry large = entry("large", "error");
  large.pictures[0].data_uri = "data:image/png;base64," + std::string(kMostPageBytes, 'A');
  const std::string html = result_page(std::vector{entry("small", "error"), large});
  EXPECT_LT(html.size(), kMostPageBytes);
  EXPECT_EQ(count(html, "data:image/"), 1);
  EXPECT_THAT(html, HasSubstr("large/plot.png"));
  EXPECT_THAT(html, HasSubstr("too large for this page"));
}

TEST(Experiments, NameSectionsOfDeviationsThatExist) {
  const std::string page = files::read_file(std::string{std::getenv("GATEFLY_SOURCE_DIR")} +
                                            "/docs/paper/deviations.md");
  for (const Experiment& experiment : all()) {
    EXPECT_FALSE(experiment.deviations.empty()) << experiment.name;
    for (const Deviation& deviation : experiment.deviations)
      EXPECT_THAT(page, HasSubstr("<a id=\"" + deviation.anchor + "\"></a>")) << experiment.name;
  }
}

TEST(Experiments, AQuickRunIsMarkedInNumbersAndPicture) {
  const Experiment experiment{.name = "none", .what = "", .run = [](const Options&) {
                                return Result{.table = {},
                                              .json = nlohmann::ordered_json::object(),
                                              .csv = "",
                                              .picture = drawing::Canvas(300, 100)};
                              }};
  Options options;
  const Result whole = run(experiment, options);
  options.quick = true;
  const Result quick = run(experiment, options);
  EXPECT_EQ(whole.json["quick"], false);
  EXPECT_EQ(quick.json["quick"], true);
  EXPECT_EQ(whole.picture.rgb(), drawing::Canvas(300, 100).rgb());
  EXPECT_NE(quick.picture.rgb(), whole.picture.rgb());
}

}  // namespace
}  // namespace gatefly::experiments
