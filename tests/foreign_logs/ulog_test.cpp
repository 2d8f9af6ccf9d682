// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/ulog.hpp"

#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/flight_log/foreign_logs/stamps.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::foreign_logs {
namespace {

using std::chrono::nanoseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <class Value>
std::string little(Value value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string message(char kind, const std::string& payload) {
  return little(static_cast<std::uint16_t>(payload.size())) + kind + payload;
}

std::string header() { return "ULog\x01\x12\x35\x01" + little(std::uint64_t{0}); }
std::string topic(const std::string& name, std::uint8_t instance, std::uint16_t id) {
  return message('A', little(instance) + little(id) + name);
}
std::string imu_format() {
  return message('F', "imu:uint64_t timestamp;float[2] rate;part[2] more;int16_t count;") +
         message('F', "part:uint8_t kind;double value;");
}
std::string imu_data(std::uint16_t id, std::uint64_t t, std::int16_t count = -5) {
  return message('D', little(id) + little(t) + little(0.25F) + little(-3.0F) +
                          little(std::uint8_t{1}) + little(1.5) + little(std::uint8_t{2}) +
                          little(2.5) + little(count));
}

TEST(Ulog, NumbersOfFormatsWithinFormatsAreFoundByTheirNames) {
  const Ulog log{header() + imu_format() + topic("imu", 0, 7) + imu_data(7, 1000) +
                 imu_data(7, 2000, 9)};
  const Ulog::Topic* const imu = log.topic("imu");
  ASSERT_NE(imu, nullptr);
  const auto number = [&](const char* name, std::size_t i) {
    return log.number(*imu, *log.field(*imu, name), i);
  };
  EXPECT_EQ(number("rate[0]", 0), 0.25);
  EXPECT_EQ(number("rate[1]", 0), -3.0);
  EXPECT_EQ(number("more[1].value", 0), 2.5);
  EXPECT_EQ(number("more[1].kind", 0), 2.0);
  EXPECT_EQ(number("count", 0), -5.0);
  EXPECT_EQ(number("count", 1), 9.0);
  EXPECT_EQ(log.whole(*imu, *log.field(*imu, "timestamp"), 1), 2000);
  EXPECT_EQ(log.field(*imu, "rate"), nullptr);
  EXPECT_FALSE(log.cut());
}

TEST(Ulog, InstancesOfATopicAreApart) {
  const Ulog log{header() + imu_format() + topic("imu", 0, 1) + topic("imu", 1, 2) +
                 imu_data(2, 5) + imu_data(1, 6) + imu_data(2, 7)};
  EXPECT_THAT(log.topics(), ElementsAre("imu", "imu:1"));
  EXPECT_EQ(log.topic("imu")->messages.size(), 1);
  EXPECT_EQ(log.topic("imu:1")->messages.size(), 2);
  EXPECT_EQ(log.topic("imu:2"), nullptr);
}

TEST(Ulog, PaddingThatIsLeftOutAtTheEndIsNoNumber) {
  const Ulog log{header() + message('F', "a:uint64_t timestamp;uint8_t x;uint8_t[7] _padding0;") +
                 topic("a", 0, 0) +
                 message('D', little(std::uint16_t{0}) + little(std::uint64_t{1}) + "\x05")};
  const Ulog::Topic* const a = log.topic("a");
  EXPECT_EQ(log.number(*a, *log.field(*a, "x"), 0), 5.0);
  EXPECT_TRUE(std::isnan(log.number(*a, *log.field(*a, "_padding0[6]"), 0)));
}

TEST(Ulog, AFileThatWasCutIsReadUpToItsLastWholeMessage) {
  const std::string whole = header() + imu_format() + topic("imu", 0, 7) + imu_data(7, 1);
  for (std::size_t more = 1; more < imu_data(7, 2).size(); ++more) {
    const Ulog log{whole + imu_data(7, 2).substr(0, more)};
    EXPECT_TRUE(log.cut());
    EXPECT_EQ(log.topic("imu")->messages.size(), 1);
  }
}

TEST(Ulog, WhatWasAppendedAfterACrashIsReadBehindTheMessageThatWasCut) {
  std::string body = header() + message('B', std::string(40, '\0')) + imu_format() +
                     topic("imu", 0, 7) + imu_data(7, 1) + imu_data(7, 2).substr(0, 9);
  const std::size_t flags = header().size() + 3;
  body[flags + 8] = 1;
  body.replace(flags + 16, 8, little(std::uint64_t{body.size()}));
  const Ulog log{body + imu_data(7, 3)};
  const Ulog::Topic* const imu = log.topic("imu");
  ASSERT_EQ(imu->messages.size(), 2);
  EXPECT_EQ(log.whole(*imu, *log.field(*imu, "timestamp"), 1), 3);
}

TEST(Ulog, WhatIsNoneIsRefusedNamingTheByte) {
  const auto why = [](const std::string& bytes) {
    return test::error_of([&] { (void)Ulog{bytes}; });
  };
  EXPECT_THAT(why("ULog"), HasSubstr("byte 0: is no ULog"));
  EXPECT_THAT(why(header() + message('D', little(std::uint16_t{3}))),
              HasSubstr("byte 19: data of topic 3, which nobody has named"));
  EXPECT_THAT(why(header() + message('!', "")), HasSubstr("byte 18: a message of type '!'"));
  EXPECT_THAT(why(header() + topic("imu", 0, 1)), HasSubstr("format 'imu' is not defined"));
  EXPECT_THAT(why(header() + message('F', "a:b x;") + message('F', "b:a x;") + topic("a", 0, 1)),
              HasSubstr("formats in formats without end"));
  EXPECT_THAT(why(header() + message('F', "a:c[9] x;") + message('F', "c:;") + topic("a", 0, 1)),
              HasSubstr("format 'c' has no parts"));
  EXPECT_THAT(why(header() + message('F', "a:float[99999] x;")), HasSubstr("no usable length"));
  EXPECT_THAT(why(header() + message('F', "a:double[40000] x;") + topic("a", 0, 1)),
              HasSubstr("longer than any message"));
}

TEST(Stamps, AreExactToTheNanosecond) {
  EXPECT_EQ(stamp_in("1403636579763555584", "ns"), nanoseconds{1403636579763555584});
  EXPECT_EQ(stamp_in("1403636579.763555584", "s"), nanoseconds{1403636579763555584});
  EXPECT_EQ(stamp_in("12.5", "ms"), nanoseconds{12'500'000});
  EXPECT_EQ(stamp_in("-3", "us"), nanoseconds{-3000});
  EXPECT_EQ(stamp_in("1.5e3", "us"), nanoseconds{1'500'000});
  EXPECT_EQ(stamp_in("0.1234567894", "s"), nanoseconds{123456789});
  for (const char* text :
       {"", "-", ".", "1.2.3", "1 2", "x", "99999999999999999999", "9e30", "nan"})
    EXPECT_EQ(stamp_in(text, "s"), std::nullopt) << text;
}

TEST(Stamps, OfAFileAreTheLastNumberInItsName) {
  EXPECT_EQ(stamp_of_name("1403636579763555584.png"), "1403636579763555584");
  EXPECT_EQ(stamp_of_name("cam2_left-1403.76.jpg"), "1403.76");
  EXPECT_EQ(stamp_of_name("frame_000012.jpeg"), "000012");
  EXPECT_EQ(stamp_of_name("12_left.png"), "12");
  EXPECT_EQ(stamp_of_name("left.png"), "");
  EXPECT_EQ(stamp_of_name(""), "");
}

}  // namespace
}  // namespace gatefly::foreign_logs
