// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/troubled_line.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gatefly::link_sim {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

constexpr int kPort = 47931, kOtherPort = 47932;

/// Numbers that were sent one by one, as they arrive at the other end.
std::vector<int> arrived_of(int count, const NetworkTroubles& troubles) {
  Datagrams end = Datagrams::at(kPort);
  TroubledLine line{Datagrams::to(kPort), troubles, {1, "network"}};
  std::vector<int> arrived;
  std::array<std::uint8_t, 64> room{};
  const auto take = [&] {
    while (const auto bytes = end.receive(room)) arrived.push_back((*bytes)[0] + 256 * (*bytes)[1]);
  };
  for (int i = 0; i < count; ++i) {
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(i % 256),
                                            static_cast<std::uint8_t>(i / 256)};
    line.send(bytes);
    take();
  }
  line.flush();
  take();
  return arrived;
}

/// The same the other way round.
std::vector<int> received_of(int count, const NetworkTroubles& troubles) {
  const Datagrams end = Datagrams::to(kOtherPort);
  TroubledLine line{Datagrams::at(kOtherPort), troubles, {1, "network"}};
  std::vector<int> received;
  for (int i = 0; i < count; ++i) {
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(i % 256),
                                            static_cast<std::uint8_t>(i / 256)};
    end.send(bytes);
    while (const auto got = line.receive()) received.push_back((*got)[0] + 256 * (*got)[1]);
  }
  return received;
}

int descents(const std::vector<int>& numbers) {
  int count = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) count += numbers[i] < numbers[i - 1];
  return count;
}

TEST(TroubledLine, WithoutTroublesAllArrivesInOrder) {
  EXPECT_THAT(arrived_of(4, {}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(received_of(4, {}), ElementsAre(0, 1, 2, 3));
}

TEST(TroubledLine, ItLosesThePartThatItShouldAndDoublesNothing) {
  for (const auto& way : {arrived_of, received_of}) {
    std::vector<int> numbers = way(5000, {.loss = 0.1, .reorder = 0.0});
    EXPECT_NEAR(static_cast<double>(numbers.size()), 4500.0, 90.0);
    EXPECT_EQ(descents(numbers), 0);
    EXPECT_EQ(std::adjacent_find(numbers.begin(), numbers.end()), numbers.end());
  }
}

TEST(TroubledLine, WhatIsSwappedComesAfterTheNextOneAndIsNotLost) {
  std::vector<int> sent = arrived_of(5000, {.loss = 0.0, .reorder = 0.1});
  EXPECT_THAT(sent, SizeIs(5000));
  // One in ten waits; whoever follows it cannot wait, too.
  EXPECT_NEAR(descents(sent), 5000 * 0.1 / 1.1, 70.0);
  std::vector<int> received = received_of(5000, {.loss = 0.0, .reorder = 0.1});
  EXPECT_GE(received.size(), 4999u) << "the last may still wait";
  EXPECT_NEAR(descents(received), 5000 * 0.1 / 1.1, 70.0);
}

}  // namespace
}  // namespace gatefly::link_sim
