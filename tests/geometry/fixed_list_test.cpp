// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/fixed_list.hpp"

#include <gtest/gtest.h>

namespace gatefly {
namespace {

TEST(FixedList, KeepsWhatFitsAndSaysWhatDoesNot) {
  FixedList<int, 2> list;
  EXPECT_TRUE(list.push_back(1));
  EXPECT_TRUE(list.push_back(2));
  EXPECT_FALSE(list.push_back(3));
  EXPECT_EQ(list.size(), 2u);
  EXPECT_EQ(list.back(), 2);
}

// In flight nothing throws and nothing reads beside the list.
TEST(FixedList, OfAnEmptyOneNothingIsTakenAndTheLastIsADefault) {
  FixedList<int, 2> list;
  list.pop_back();
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(list.back(), 0);
  EXPECT_TRUE(list.push_back(7));
  EXPECT_EQ(list.back(), 7);
}

TEST(FixedList, SortsInPlaceAndKeepsTheOrderOfEquals) {
  FixedList<int, 5> list;
  for (const int x : {31, 12, 32, 11, 20}) (void)list.push_back(x);
  insertion_sort(list, [](int a, int b) { return a / 10 < b / 10; });
  const int sorted[] = {12, 11, 20, 31, 32};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(list[i], sorted[i]);
}

}  // namespace
}  // namespace gatefly
