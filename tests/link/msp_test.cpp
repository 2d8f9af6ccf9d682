// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/msp.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"

#include "support/for_all.hpp"

namespace gatefly::msp {
namespace {

using test::for_all;
using testing::ElementsAre;
using testing::ElementsAreArray;
using Data = std::vector<std::uint8_t>;

/// A frame with bytes of its own.
struct Kept {
  std::uint16_t id;
  Data payload;
  Direction direction;
  Version version;
  friend bool operator==(const Kept&, const Kept&) = default;
};

Kept kept(const Frame& frame) {
  return {frame.id, {frame.payload.begin(), frame.payload.end()}, frame.direction, frame.version};
}

Data bytes_of(const Kept& frame) {
  Data out(kMostPayload + kFrameOverhead);
  out.resize(encode_frame({frame.id, frame.payload, frame.direction, frame.version}, out));
  return out;
}

std::vector<Kept> frames_in(const Data& bytes) {
  std::vector<Kept> frames;
  Stream stream;
  stream.feed(bytes, [&](const Frame& frame) { frames.push_back(kept(frame)); });
  return frames;
}

Data random_bytes(Rng& rng, int count) {
  Data bytes(static_cast<std::size_t>(count));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(rng.next());
  return bytes;
}

Kept any_frame(Rng& rng, int most_payload) {
  const bool version_2 = rng.uniform_index(2) == 1;
  constexpr std::array kDirections{Direction::kToController, Direction::kFromController,
                                   Direction::kRefused};
  return {static_cast<std::uint16_t>(rng.uniform_index(version_2 ? 0x10000 : 0x100)),
          random_bytes(rng, rng.uniform_index(most_payload + 1)),
          kDirections[static_cast<std::size_t>(rng.uniform_index(3))],
          version_2 ? Version::k2 : Version::k1};
}

void append(Data& to, const Data& more) { to.insert(to.end(), more.begin(), more.end()); }

// Written out by hand from the protocol's description, not by our encoder.
TEST(Msp, AFrameHasTheBytesOfItsDescription) {
  EXPECT_THAT(bytes_of({1, {}, Direction::kToController, Version::k1}),
              ElementsAre('$', 'M', '<', 0, 1, 1));
  EXPECT_THAT(bytes_of({108, {0x0A, 0x00}, Direction::kFromController, Version::k1}),
              ElementsAre('$', 'M', '>', 2, 108, 0x0A, 0x00, 2 ^ 108 ^ 0x0A));
  EXPECT_THAT(bytes_of({100, {}, Direction::kToController, Version::k2}),
              ElementsAre('$', 'X', '<', 0, 100, 0, 0, 0, 0x8F));
}

// The example of the description of MSP v2; its flags, 0xA5, mean nothing.
TEST(Msp, TheExampleOfVersion2IsRead) {
  const std::string_view hello = "Hello flying world";
  Data bytes{'$', 'X', '<', 0xA5, 0x42, 0x42, 0x12, 0x00};
  bytes.insert(bytes.end(), hello.begin(), hello.end());
  bytes.push_back(0x82);
  EXPECT_THAT(frames_in(bytes),
              ElementsAre(Kept{
                  0x4242, {hello.begin(), hello.end()}, Direction::kToController, Version::k2}));
}

TEST(Msp, ChecksumsAreThoseOfTheirCatalogues) {
  constexpr std::array<std::uint8_t, 9> kCheck{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(link::crc8_of(kCheck), 0xBC);     // CRC-8/DVB-S2
  EXPECT_EQ(link::crc16_of(kCheck), 0x6F91);  // CRC-16/MCRF4XX
  EXPECT_EQ(link::xor_of(kCheck), 0x31);
}

TEST(Msp, EveryFrameComesBack) {
  for_all(300, [](Rng& rng) {
    const Kept frame = any_frame(rng, static_cast<int>(kMostPayload));
    EXPECT_THAT(frames_in(bytes_of(frame)), ElementsAre(frame));
  });
}

TEST(Msp, WhatDoesNotFitIsNotWritten) {
  const Data payload(kMostPayload + 1);
  std::array<std::uint8_t, 2048> out{};
  EXPECT_EQ(encode_frame({1, payload}, out), 0u);
  EXPECT_EQ(encode_frame({256, {}, Direction::kToController, Version::k1}, out), 0u);
  for (std::size_t room = 0; room < 11; ++room)
    EXPECT_EQ(encode_frame({1, Bytes{payload}.first(2)}, std::span{out}.first(room)), 0u) << room;
  EXPECT_EQ(encode_frame({1, Bytes{payload}.first(2)}, std::span{out}.first(11)), 11u);
}

TEST(MspStream, FindsEveryFrameBetweenGarbageThatHoldsNone) {
  int by_chance = 0;  // garbage whose checksum of 8 bits is right
  for_all(200, [&](Rng& rng) {
    std::vector<Kept> sent;
    Data bytes;
    std::size_t garbage = 0;
    for (int i = 0; i < 5; ++i) {
      // Starts of frames among it, which claim bytes of the frames that follow.
      Data between = random_bytes(rng, rng.uniform_index(40));
      for (std::uint8_t& byte : between)
        if (rng.uniform_index(4) == 0)
          byte = static_cast<std::uint8_t>("$MX<>"[rng.uniform_index(5)]);
      if (rng.uniform_index(3) == 0) between = {'$', 'X', '>', 0, 1, 1, 200, 0, '$'};
      garbage += between.size();
      append(bytes, between);
      sent.push_back(any_frame(rng, 60));
      append(bytes, bytes_of(sent.back()));
    }
    // A frame that claims more than there is waits for it: what follows pushes it out.
    append(bytes, Data(kMostPayload + kFrameOverhead, 0));
    for (const Kept& frame : frames_in(bytes))
      if (std::find(sent.begin(), sent.end(), frame) == sent.end())
        return ++by_chance, test::not_a_case();
    EXPECT_THAT(frames_in(bytes), ElementsAreArray(sent));
    Stream stream;
    stream.feed(bytes, [](const Frame&) {});
    EXPECT_EQ(stream.skipped(), garbage + kMostPayload + kFrameOverhead);
  });
  EXPECT_LE(by_chance, 5);
}

TEST(MspStream, PiecesOfAnySizeAreAsGoodAsTheWhole) {
  for_all(100, [](Rng& rng) {
    Data bytes;
    for (int i = 0; i < 4; ++i) append(bytes, bytes_of(any_frame(rng, 300)));
    std::vector<Kept> frames;
    Stream stream;
    for (std::size_t at = 0; at < bytes.size();) {
      const auto size =
          std::min(bytes.size() - at, static_cast<std::size_t>(rng.uniform_index(50)));
      stream.feed(Bytes{bytes}.subspan(at, size),
                  [&](const Frame& f) { frames.push_back(kept(f)); });
      at += size;
    }
    EXPECT_EQ(frames, frames_in(bytes));
    EXPECT_EQ(frames.size(), 4u);
  });
}

TEST(MspStream, AFlippedBitIsNoticed) {
  for_all(300, [](Rng& rng) {
    Data bytes = bytes_of(any_frame(rng, 20));
    bytes[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(bytes.size())))] ^=
        static_cast<std::uint8_t>(1 << rng.uniform_index(8));
    const auto frames = frames_in(bytes);
    // Version 1 does not cover its direction: '<' ^ '>' is one bit.
    for (const Kept& frame : frames) EXPECT_EQ(bytes_of(frame), bytes);
    EXPECT_TRUE(frames.empty() || bytes[2] == '<' || bytes[2] == '>');
  });
}

TEST(MspStream, AMillionRandomBytesAreSurvivedAndALastFrameIsFound) {
  const Kept frame{105, {1, 2, 3, 4}, Direction::kFromController, Version::k2};
  const Data last = bytes_of(frame);
  Rng rng{7};
  Stream stream;
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    Data bytes = random_bytes(rng, 1000);
    for (std::uint8_t& byte : bytes)
      if (byte < 80) byte = static_cast<std::uint8_t>("$MX<>!"[byte % 6]);
    stream.feed(bytes, [](const Frame&) {});
  }
  stream.feed(last, [&](const Frame& f) { found += kept(f) == frame ? 1 : 0; });
  const Data zeros(kMostPayload + kFrameOverhead, 0);
  stream.feed(zeros, [&](const Frame& f) { found += kept(f) == frame ? 1 : 0; });
  EXPECT_EQ(found, 1);
}

TEST(MspStream, AfterARestartWhatHadBegunIsForgotten) {
  const Data bytes = bytes_of({1, {1, 2, 3}, Direction::kFromController, Version::k2});
  Stream stream;
  int found = 0;
  stream.feed(Bytes{bytes}.first(8), [&](const Frame&) { ++found; });
  stream.restart();
  stream.feed(bytes, [&](const Frame&) { ++found; });
  EXPECT_EQ(found, 1);
  EXPECT_EQ(stream.skipped(), 8u);
}

TEST(MspMessages, RatesAreReadFromTheirPlaces) {
  // As a 4.4.3 sends the qualifier's profile: rc_rate 55, 55, 57; super rate 75, 75, 70; curve 54, 68.
  const Data payload{55, 0, 75, 75,  70,   0,    54,   68,   0,    0,    0, 57,
                     55, 0, 0,  100, 0xCE, 0x07, 0xCE, 0x07, 0xCE, 0x07, 0};
  const auto tuning = link::decoded<RcTuning>(payload);
  ASSERT_TRUE(tuning);
  EXPECT_EQ(tuning->roll_rc_rate, 55);
  EXPECT_EQ(tuning->yaw_rc_rate, 57);
  EXPECT_EQ(tuning->pitch_rc_rate, 55);
  EXPECT_THAT(tuning->super_rate, ElementsAre(75, 75, 70));
  EXPECT_EQ(tuning->throttle_mid, 54);
  EXPECT_EQ(tuning->throttle_expo, 68);
  EXPECT_THAT(tuning->rate_limit, ElementsAre(1998, 1998, 1998));
  EXPECT_EQ(tuning->rates_type, 0);
  EXPECT_EQ(tuning->throttle_hover, RcTuning::kNoHover);
  Data later = payload;
  later.push_back(30);
  later.push_back(99);
  EXPECT_EQ(link::decoded<RcTuning>(later)->throttle_hover, 30);
  EXPECT_FALSE(link::decoded<RcTuning>(Bytes{payload}.first(22)));
}

TEST(MspMessages, WhatIsTooShortIsNone) {
  const Data bytes(64, 0);
  std::apply(
      [&](auto... each) {
        const auto check = [&]<class Message>(const Message&) {
          const std::size_t least = link::sizes_of<Message>().least();
          EXPECT_TRUE(link::decoded<Message>(Bytes{bytes}.first(least))) << Message::kName;
          EXPECT_FALSE(link::decoded<Message>(Bytes{bytes}.first(least - 1))) << Message::kName;
          EXPECT_TRUE(link::decoded<Message>(bytes)) << Message::kName;
        };
        (check(each), ...);
      },
      Messages{});
}

TEST(MspLists, StatusTellsModesByTheirPlaceInTheListOfBoxes) {
  const auto ids = box_ids_in(Data{0, 1, 27, 50});
  ASSERT_TRUE(ids);
  Data payload{0x7D, 0, 3, 0, 0x21, 0, 0b1001, 0, 0, 0, 0, 12, 0, 0, 0, 0, 26, 0, 0, 0, 0x02, 0};
  const auto status = status_in(payload);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->on(Box::kArm, *ids), true);
  EXPECT_EQ(status->on(Box::kAngle, *ids), false);
  EXPECT_EQ(status->on(Box::kMspOverride, *ids), true);
  EXPECT_EQ(status->on(Box::kHorizon, *ids), std::nullopt);
  EXPECT_EQ(status->bus_errors, 3);
  EXPECT_EQ(status->load_percent, 12);
  EXPECT_TRUE(status->gyro && status->accelerometer && !status->barometer);
  EXPECT_EQ(status->arming_refused, 0x02000000u);
  EXPECT_FALSE(status_in(Bytes{payload}.first(20)));

  // More than 32 modes: further bytes are between.
  payload = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 0, 0, 0, 0, 0, 1, 0b10, 26, 0, 0, 0, 0, 0};
  const auto many = status_in(payload);
  ASSERT_TRUE(many);
  EXPECT_TRUE(many->modes[31] && many->modes[33] && many->modes.count() == 2);
  EXPECT_EQ(many->arming_refused, 0u);
}

TEST(MspLists, ModeRangesAreInStepsOf25Microseconds) {
  const auto ranges = mode_ranges_in(Data{0, 0, 32, 48, 0, 0, 0, 0, 50, 4, 36, 48});
  ASSERT_TRUE(ranges);
  ASSERT_EQ(ranges->size(), 2u);
  EXPECT_EQ((*ranges)[0].box, Box::kArm);
  EXPECT_EQ((*ranges)[0].from, 1700);
  EXPECT_EQ((*ranges)[0].below, 2100);
  EXPECT_EQ((*ranges)[1].box, Box::kMspOverride);
  EXPECT_EQ((*ranges)[1].aux, 4);
  EXPECT_TRUE((*ranges)[1].holds(1800) && !(*ranges)[1].holds(1799));
  EXPECT_FALSE(mode_ranges_in(Data{1, 2, 3}));
  EXPECT_FALSE(mode_ranges_in(Data(164)));
}

TEST(MspLists, NamesOfModesEndWithASemicolon) {
  const std::string_view names = "ARM;ANGLE;MSP OVERRIDE;FAIL";
  const Data payload(names.begin(), names.end());
  EXPECT_EQ(box_name_in(payload, 0), "ARM");
  EXPECT_EQ(box_name_in(payload, 2), "MSP OVERRIDE");
  EXPECT_EQ(box_name_in(payload, 3), "") << "cut off";
  EXPECT_EQ(box_name_in(payload, 9), "");
}

TEST(MspLists, ChannelsAreRefusedWholeWhenThereAreTooManyOrHalfOfOne) {
  const auto channels = channels_in(Data{0xDC, 0x05, 0xE8, 0x03});
  ASSERT_TRUE(channels);
  EXPECT_THAT(std::vector(channels->begin(), channels->end()), ElementsAre(1500, 1000));
  EXPECT_FALSE(channels_in(Data(3)));
  EXPECT_FALSE(channels_in(Data(2 * kMostChannels + 2)));
}

TEST(MspLists, SeveralAnswersAreTakenApartInTheOrderOfTheQuestions) {
  const Data ids{108, 105, 1};
  const Data payload{2, 7, 8, 0, 3, 0, 1, 45};
  std::vector<std::pair<int, Data>> answers;
  const auto take = [&](std::uint16_t id, Bytes bytes) {
    answers.push_back({id, {bytes.begin(), bytes.end()}});
  };
  EXPECT_TRUE(each_answer(ids, payload, take));
  EXPECT_THAT(answers, ElementsAre(std::pair{108, Data{7, 8}}, std::pair{105, Data{}},
                                   std::pair{1, Data{0, 1, 45}}));
  answers.clear();
  EXPECT_TRUE(each_answer(ids, Bytes{payload}.first(3), take))
      << "the controller's buffer was full";
  EXPECT_EQ(answers.size(), 1u);
  EXPECT_FALSE(each_answer(ids, Bytes{payload}.first(6), take)) << "cut in the middle";
  EXPECT_FALSE(each_answer(Bytes{ids}.first(2), payload, take)) << "more than was asked for";
}

}  // namespace
}  // namespace gatefly::msp
