// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/drone_file.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/live/hand_over_mark.hpp"

#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

std::string the_file() {
  return files::read_file(support::source_folder() / "tests" / "live" / "fake_drone.toml");
}

/// The complaint about the file with `from` replaced by `to`.
std::string complaint(const std::string& from, const std::string& to) {
  const test::TempFolder folder;
  std::string text = the_file();
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  return error_of([&] { (void)read_drone(folder.file("drone.toml", text)); });
}

DroneFile drone() {
  const test::TempFolder folder;
  return read_drone(folder.file("drone.toml", the_file()));
}

TEST(DroneFile, EveryKeyMustBeThere) {
  const std::string text = the_file();
  for (std::size_t at = 0; (at = text.find(" = ", at)) != std::string::npos; ++at) {
    const auto begin = text.rfind('\n', at) + 1, end = text.find('\n', at);
    const std::string line = text.substr(begin, end - begin), key = text.substr(begin, at - begin);
    if (key.find('#') != std::string::npos) continue;
    EXPECT_THAT(complaint(line + "\n", "\n"), AllOf(HasSubstr("drone.toml:"), HasSubstr(key)))
        << line;
  }
}

TEST(DroneFile, WhatNobodyKnowsIsRefused) {
  EXPECT_THAT(complaint("\"BTFL\"", "\"INAV\""), HasSubstr("controller.firmware"));
  EXPECT_THAT(complaint("[battery]", "[battery]\ncells = 6"), HasSubstr("battery.cells"));
  EXPECT_THAT(complaint("[battery]", "[wings]\n[battery]"), HasSubstr("wings"));
  EXPECT_THAT(complaint("\"actual\"", "\"kiss\""),
              HasSubstr("must be \"betaflight\" or \"actual\""));
  EXPECT_THAT(complaint("\"front-left-up\"", "\"front-right-down\""), HasSubstr("align the board"));
  EXPECT_THAT(complaint("mid_us = 1500", "mid_us = 1500.5"), HasSubstr("a whole number"));
  EXPECT_THAT(complaint("place = [0, 1, 3, 2]", "place = [0, 1, 3, 3]"),
              HasSubstr("each of the four places once"));
  EXPECT_THAT(complaint("override = [0, 1, 2, 3]", "override = [0, 1, 2, 2]"),
              HasSubstr("the switches never"));
  EXPECT_THAT(complaint("hover_stick_us = 1425", "hover_stick_us = 1060"),
              HasSubstr("a throttle of 5 to 80 %"));
}

TEST(DroneFile, HoverIsTheHoverStickAndMoreThrustIsMoreStick) {
  const DroneFile d = drone();
  EXPECT_NEAR(d.sticks({0, 0, 0}, kGravity).throttle, d.hover_stick, 1);
  EXPECT_GT(d.sticks({0, 0, 0}, 1.2 * kGravity).throttle, d.hover_stick);
  EXPECT_LE(d.sticks({0, 0, 0}, 0).throttle, d.receiver.min_check);
  EXPECT_EQ(d.sticks({0, 0, 0}, std::nan("")).throttle, d.receiver.min_check);
}

TEST(DroneFile, RatesAreTurnedIntoSticksByTheCurveNotByALine) {
  const DroneFile d = drone();
  const double wanted = 90 * kDegree;  // a fifth of full stick's 450 °/s
  const msp::Sticks sticks = d.sticks({wanted, 0, 0}, kGravity);
  EXPECT_NEAR(d.rates.roll.rate(sticks.roll), wanted, 1 * kDegree);
  EXPECT_GT(sticks.roll, 1600 + 30) << "the line would say 1600";
}

TEST(HandOverTest, IsBoundToEveryConstantAndToTheProgram) {
  DroneFile d = drone();
  EXPECT_FALSE(hand_over_tested(d, "1.0"));
  d.tested = hand_over_mark(d, "1.0");
  EXPECT_TRUE(hand_over_tested(d, "1.0"));
  EXPECT_FALSE(hand_over_tested(d, "1.1"));
  d.tuning.super_rate[2] += 1;
  EXPECT_FALSE(hand_over_tested(d, "1.0"));
}

TEST(HandOverMark, IsPutInReplacedAndTakenOutAgainAndTheRestStays) {
  const std::string plain = the_file(), marked = with_hand_over_mark(drone(), plain, "a1");
  EXPECT_EQ(marked, plain + "\n[hand_over_test]\npassed = \"a1\"\n");
  EXPECT_EQ(with_hand_over_mark(drone(), marked, "b2"),
            plain + "\n[hand_over_test]\npassed = \"b2\"\n");
  EXPECT_EQ(with_hand_over_mark(drone(), marked, ""), plain);
}

TEST(HandOverMark, AtTheBeginningItIsReplacedToo) {
  EXPECT_EQ(with_hand_over_mark(
                drone(), "  [hand_over_test]  # ours\npassed = \"a\"\n[drone]\nname = \"x\"\n", ""),
            "[drone]\nname = \"x\"\n");
}

TEST(HandOverMark, WrittenInAnotherWayItIsRefused) {
  EXPECT_THROW((void)with_hand_over_mark(drone(), "hand_over_test.passed = \"a\"\n", "b"),
               std::runtime_error);
}

}  // namespace
}  // namespace gatefly::live
