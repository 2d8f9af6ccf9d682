// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/interview.hpp"

#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

namespace gatefly::guard {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Data = std::vector<std::uint8_t>;

/// Answers of a drone as the qualifier's, by message.
std::map<int, Data> healthy() {
  return {{2, {'B', 'T', 'F', 'L'}},
          {1, {0, 1, 45}},
          {111, {55, 0, 75, 75,  70,   0, 54,   68, 0,    0, 0, 57,
                 55, 0, 0,  100, 0xCE, 7, 0xCE, 7,  0xCE, 7, 0}},
          {125, {0, 0, 40, 50, 0}},
          {44, {0, 0x6C, 7, 0xDC, 5, 0x1A, 4, 0, 0x75, 3, 0x43, 8}},
          {64, {0, 1, 3, 2, 4, 5, 6, 7}},
          {119, {0, 1, 27, 50}},
          {34, {0, 0, 32, 48, 1, 1, 32, 48, 50, 4, 32, 48, 0, 0, 0, 0}},
          {101, {125, 0, 0, 0, 0x21, 0, 0, 0, 0, 0, 0, 12, 0, 0, 0, 0, 26, 0, 0, 0, 2, 0}}};
}

DroneFacts asked(const std::map<int, Data>& answers) {
  Interview interview;
  for (int i = 0; i < 20 && interview.question(); ++i) {
    const std::uint16_t id = *interview.question();
    interview.take({.id = 999, .payload = {}, .direction = msp::Direction::kFromController});
    const auto answer = answers.find(id);
    if (answer == answers.end())
      interview.take({.id = id, .payload = {}, .direction = msp::Direction::kRefused});
    else
      interview.take(
          {.id = id, .payload = answer->second, .direction = msp::Direction::kFromController});
  }
  EXPECT_FALSE(interview.question());
  return interview.facts();
}

std::vector<Complaint> complaints(const std::map<int, Data>& answers) {
  const Complaints found = complaints_about(asked(answers));
  return {found.begin(), found.end()};
}

/// A healthy drone, but for one byte of one answer.
std::vector<Complaint> with(int id, std::size_t at, std::uint8_t value) {
  auto answers = healthy();
  answers.at(id).at(at) = value;
  return complaints(answers);
}

TEST(Interview, OfAHealthyDroneNothingIsComplainedAboutAndEveryConstantIsKnown) {
  EXPECT_THAT(complaints(healthy()), IsEmpty());
  const DroneFacts facts = asked(healthy());
  EXPECT_NEAR(facts.rates()->roll.rate(2000) / kDegree, 440, 1e-9);
  EXPECT_EQ(facts.throttle()->throttle(1525), 528);
  EXPECT_TRUE(facts.order());
}

TEST(Interview, EachFaultIsNamedAndNoOther) {
  EXPECT_THAT(with(2, 0, 'I'), ElementsAre(Complaint::kNotBetaflight));
  EXPECT_THAT(with(1, 2, 40), ElementsAre(Complaint::kApi));
  EXPECT_THAT(with(111, 22, 2), ElementsAre(Complaint::kRates));
  EXPECT_THAT(with(111, 14, 1), ElementsAre(Complaint::kThrottleCurve));
  EXPECT_THAT(with(64, 1, 0), ElementsAre(Complaint::kChannelOrder));
  EXPECT_THAT(with(101, 4, 0x01), ElementsAre(Complaint::kNoGyro));
  EXPECT_THAT(with(101, 4, 0x20), ElementsAre(Complaint::kNoAccelerometer));
  EXPECT_THAT(with(101, 2, 7), ElementsAre(Complaint::kBusErrors));
  EXPECT_THAT(with(101, 6, 1), ElementsAre(Complaint::kArmed));
  EXPECT_THAT(with(34, 0, 3), ElementsAre(Complaint::kNoArmSwitch));
  EXPECT_THAT(with(119, 3, 51), ElementsAre(Complaint::kNoOverride));
  EXPECT_THAT(with(34, 8, 3), ElementsAre(Complaint::kNoOverrideSwitch));
  EXPECT_THAT(with(34, 9, 0), ElementsAre(Complaint::kOneSwitchForBoth));
}

TEST(Interview, WhatIsNotAnsweredIsNotGuessed) {
  EXPECT_FALSE(asked({}).rates());
  EXPECT_FALSE(asked({}).throttle());
  EXPECT_FALSE(asked({}).order());
  for (const auto& [id, answer] : healthy()) {
    auto answers = healthy();
    answers.erase(id);
    EXPECT_FALSE(complaints(answers).empty()) << id;
    answers[id] = {};  // an answer without anything in it
    EXPECT_FALSE(complaints(answers).empty()) << id;
  }
  Interview silent;
  for (int i = 0; i < 9; ++i) silent.skip();
  EXPECT_FALSE(silent.question());
  silent.skip();
  EXPECT_FALSE(silent.question());
}

TEST(Interview, OurOwnQuestionComingBackIsNoAnswer) {
  Interview interview;
  const auto first = interview.question();
  interview.take({.id = *first, .payload = {}, .direction = msp::Direction::kToController});
  EXPECT_EQ(interview.question(), first);
}

}  // namespace
}  // namespace gatefly::guard
