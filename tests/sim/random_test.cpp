// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/sim/correlated_draw.hpp"
#include "gatefly/sim/normal.hpp"
#include "gatefly/sim/streams.hpp"

namespace gatefly::sim {
namespace {

namespace fs = std::filesystem;

/// The names that the simulator's code gives to streams, and how often. One for each of several
/// things: with a " " behind.
std::map<std::string, int> names_in_code() {
  const char* root = std::getenv("GATEFLY_SOURCE_DIR");
  std::map<std::string, int> names;
  if (root == nullptr) return names;
  // Stream{seed, "name"}, schedule_{config.seed, "name"}; draws("name", ...);
  // CorrelatedDraws: {seed, "name", staying...}
  const std::regex stream{R"~(\{\s*(?:1|[\w.]*seed_?),\s*"([^"]+)"\s*\})~"},
      correlated{R"~(\{\s*seed,\s*"([^"]+)",)~"}, draws{R"~(draws\("([^"]+)")~"},
      where{R"~("([\w ]+ where)")~"};
  for (const char* folder : {"sim", "simulated_race", "simulated_race/closed_loop"})
    for (const auto& entry :
         fs::directory_iterator(fs::path{root} / "src/simulator/gatefly" / folder)) {
      const std::string extension = entry.path().extension();
      if ((extension != ".cpp" && extension != ".hpp") || entry.path().filename() == "streams.hpp")
        continue;
      std::ifstream file{entry.path()};
      const std::string text{std::istreambuf_iterator<char>{file}, {}};
      const auto each = [&](const std::regex& pattern, const char* end) {
        for (std::sregex_iterator it{text.begin(), text.end(), pattern}, last; it != last; ++it)
          ++names[(*it)[1].str() + end];
      };
      each(stream, ""), each(correlated, " "), each(draws, " "), each(where, " ");
    }
  return names;
}

TEST(Streams, AreTheListedOnesEachUsedInOnePlace) {
  if (std::getenv("GATEFLY_SOURCE_DIR") == nullptr) GTEST_SKIP() << "without GATEFLY_SOURCE_DIR";
  std::set<std::string> used;
  for (const auto& [name, places] : names_in_code()) {
    // a decoy's and a place's corners are drawn where each is found
    EXPECT_EQ(places, 1) << name;
    used.insert(name);
  }
  EXPECT_EQ(used, std::set<std::string>(kStreams.begin(), kStreams.end()));
}

/// The names as they key streams: of those with a number the first three.
std::vector<std::string> keys() {
  std::vector<std::string> names;
  for (const std::string_view name : kStreams) {
    if (name.back() != ' ') {
      names.emplace_back(name);
      continue;
    }
    for (const char* number : {"0", "1", "2"}) names.push_back(std::string{name} + number);
  }
  return names;
}

TEST(Streams, OneMoreDrawInOneChangesNoOther) {
  const std::vector<std::string> names = keys();
  std::vector<std::vector<double>> before;
  for (const auto& name : names) {
    Stream stream{7, name};
    before.emplace_back();
    for (int i = 0; i < 8; ++i) before.back().push_back(stream.uniform());
  }
  for (const auto& more : names) {
    std::vector<Stream> streams;
    for (const auto& name : names) streams.emplace_back(7, name);
    for (int i = 0; i < 8; ++i)
      for (std::size_t k = 0; k < names.size(); ++k) {
        if (names[k] == more) (void)streams[k].uniform();
        const double value = streams[k].uniform();
        if (names[k] != more) {
          ASSERT_EQ(value, before[k][static_cast<std::size_t>(i)]) << names[k] << " by " << more;
        }
      }
  }
}

// 60 streams, 2000 draws: none is another's, none goes with another by more than 5 standard errors.
TEST(Streams, AreIndependentOfEachOther) {
  constexpr int kDraws = 2000;
  const std::vector<std::string> names = keys();
  std::vector<std::vector<double>> z;
  for (const auto& name : names) {
    Stream stream{7, name};
    z.emplace_back();
    for (int i = 0; i < kDraws; ++i) z.back().push_back(std::sqrt(12.0) * (stream.uniform() - 0.5));
  }
  for (std::size_t a = 0; a < names.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      double sum = 0.0;
      for (std::size_t i = 0; i < kDraws; ++i) sum += z[a][i] * z[b][i];
      EXPECT_NEAR(sum / kDraws, 0.0, 5.0 / std::sqrt(kDraws)) << names[a] << " and " << names[b];
    }
}

TEST(Normal, QuantileUndoesTheDistribution) {
  for (const double x : {-3.0, -1.0, 0.0, 0.5, 2.5})
    EXPECT_NEAR(normal_quantile(normal_cdf(x)), x, 1e-9);
  EXPECT_NEAR(normal_cdf(1.959964), 0.975, 1e-6);
}

TEST(CorrelatedDraw, HasTheSharesThatItWasGiven) {
  constexpr Staying kStaying{.seed = 0.2, .row = 0.5, .time = 0.4};
  constexpr double kPeriod = 1.0 / 15.0;
  constexpr int kSeeds = 4000;
  // products of what one thing has now, a picture later, much later, and what another has
  double square = 0.0, next = 0.0, much_later = 0.0, other = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    CorrelatedDraws draws{seed, "test", kStaying, true};
    const double now = draws.of(1).normal(1.0), elsewhere = draws.of(2).normal(1.0),
                 later = draws.of(1).normal(1.0 + kPeriod), late = draws.of(1).normal(9.0);
    square += now * now, next += now * later, much_later += now * late, other += now * elsewhere;
  }
  const double error = 5.0 * std::sqrt(2.0 / kSeeds);
  EXPECT_NEAR(square / kSeeds, 1.0, error);
  EXPECT_NEAR(next / kSeeds, 0.2 + 0.5 * std::exp(-kPeriod / 0.4), error);
  EXPECT_NEAR(much_later / kSeeds, 0.2, error);
  EXPECT_NEAR(other / kSeeds, 0.2, error);
}

TEST(CorrelatedDraw, FollowsFromTheTimeNotFromThePicturesThatCameThrough) {
  constexpr Staying kStaying{.seed = 0.1, .row = 0.6, .time = 0.3};
  CorrelatedDraw all{kStaying, 0.3, Stream{1, "test"}}, some{kStaying, 0.3, Stream{1, "test"}};
  for (int i = 0; i < 30; ++i) {
    const double t = 0.2 + i / 15.0, value = all.normal(t);
    if (i % 3 == 0) {
      EXPECT_EQ(some.normal(t), value) << i;
    }
  }
}

TEST(CorrelatedDraw, WhatHappensDoesSoAsOftenAsItShouldAndItsSurplusIsUniform) {
  constexpr int kSeeds = 5000;
  int happened = 0;
  double surplus_sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    CorrelatedDraws draws{seed, "test", {.seed = 0.1, .row = 0.6, .time = 0.3}, false};
    double surplus = -1.0;
    if (!draws.happens(3, 0.3, 2.0, surplus)) continue;
    ++happened, surplus_sum += surplus;
  }
  EXPECT_NEAR(happened / double{kSeeds}, 0.3, 5 * std::sqrt(0.21 / kSeeds));
  EXPECT_NEAR(surplus_sum / happened, 0.5, 5 * std::sqrt(1.0 / 12.0 / happened));
}

}  // namespace
}  // namespace gatefly::sim
