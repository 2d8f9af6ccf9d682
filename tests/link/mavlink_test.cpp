// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/mavlink.hpp"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_hil.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"

#include "support/for_all.hpp"

namespace gatefly::mavlink {
namespace {

using test::for_all;
using testing::ElementsAre;
using Data = std::vector<std::uint8_t>;

template <class OnMessage>
void each_message(OnMessage&& on_message) {
  std::apply([&](const auto&... each) { (on_message(each), ...); },
             std::tuple_cat(Telemetry{}, Commands{}, HardwareInLoop{}));
}

/// A frame that node-mavlink wrote, with what it was told to write.
struct Golden {
  std::string message;
  int sequence = 0, system = 0, component = 0;
  Data frame;
  std::vector<std::string> fields;  ///< "name value value ..."
};

Data from_hex(const std::string& hex) {
  Data bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

const std::vector<Golden>& golden_frames() {
  static const std::vector<Golden> all = [] {
    const char* root = std::getenv("GATEFLY_SOURCE_DIR");
    std::ifstream file{std::string{root != nullptr ? root : "."} +
                       "/tests/link/data/mavlink_golden.txt"};
    std::vector<Golden> found;
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with('#')) continue;
      if (line.starts_with("  ")) {
        found.back().fields.push_back(line.substr(2));
        continue;
      }
      Golden golden;
      std::string hex;
      std::istringstream{line} >> golden.message >> golden.sequence >> golden.system >>
          golden.component >> hex;
      golden.frame = from_hex(hex);
      found.push_back(golden);
    }
    return found;
  }();
  return all;
}

template <class T>
T parsed(const std::string& text) {
  if constexpr (std::floating_point<T>) return std::strtof(text.c_str(), nullptr);
  if constexpr (std::same_as<T, std::uint64_t>)
    return std::strtoull(text.c_str(), nullptr, 10);
  else
    return static_cast<T>(std::strtoll(text.c_str(), nullptr, 10));
}

/// Compares a message's fields, in order and by name, with what stands in a golden frame.
class FieldComparison {
 public:
  explicit FieldComparison(const std::vector<std::string>& fields) : fields_{fields} {}
  template <class T>
  void operator()(std::string_view name, const T& value, std::string_view meaning) {
    (*this)(name, std::array<T, 1>{value}, meaning);
  }
  template <class T, std::size_t N>
  void operator()(std::string_view name, const std::array<T, N>& values, std::string_view) {
    ASSERT_LT(next_, fields_.size());
    std::istringstream line{fields_[next_++]};
    std::string word;
    line >> word;
    EXPECT_EQ(word, name);
    for (const T& value : values) {
      ASSERT_TRUE(line >> word);
      EXPECT_EQ(value, parsed<T>(word)) << name;
    }
    EXPECT_FALSE(line >> word) << name;
  }
  void later() {}
  [[nodiscard]] bool all_seen() const { return next_ == fields_.size(); }

 private:
  const std::vector<std::string>& fields_;
  std::size_t next_ = 0;
};

TEST(Mavlink, ThereIsAGoldenFrameOfEveryMessage) {
  EXPECT_EQ(golden_frames().size(), 3u * 26u);
  int missing = 0;
  each_message([&](const auto& message) {
    int count = 0;
    for (const Golden& golden : golden_frames()) count += golden.message == message.kName ? 1 : 0;
    missing += count == 3 ? 0 : 1;
  });
  EXPECT_EQ(missing, 0);
}

TEST(Mavlink, WhatAnotherLibraryWroteIsReadFieldByField) {
  for (const Golden& golden : golden_frames()) {
    SCOPED_TRACE(golden.message);
    int frames = 0;
    Stream stream;
    stream.feed(golden.frame, [&](const Frame& frame) {
      ++frames;
      EXPECT_EQ(frame.sender.sequence, golden.sequence);
      EXPECT_EQ(frame.sender.system, golden.system);
      EXPECT_EQ(frame.sender.component, golden.component);
      each_message([&]<class Message>(const Message&) {
        if (golden.message != Message::kName) return;
        const auto message = message_in<Message>(frame);
        ASSERT_TRUE(message);
        FieldComparison comparison{golden.fields};
        Message::layout(*message, comparison);
        EXPECT_TRUE(comparison.all_seen());
      });
    });
    EXPECT_EQ(frames, 1);
    EXPECT_EQ(stream.skipped(), 0u);
  }
}

TEST(Mavlink, WrittenAgainItIsTheSameToTheByte) {
  for (const Golden& golden : golden_frames()) {
    SCOPED_TRACE(golden.message);
    Stream stream;
    stream.feed(golden.frame, [&](const Frame& frame) {
      each_message([&]<class Message>(const Message&) {
        const auto message = message_in<Message>(frame);
        if (!message) return;
        Data out(kLongestFrame);
        out.resize(encode_message(*message, frame.sender, out));
        // It sends no byte of a payload of zeros; the protocol says that the first one stays.
        if (frame.payload.empty())
          EXPECT_EQ(out.size(), golden.frame.size() + 1);
        else
          EXPECT_EQ(out, golden.frame);
      });
    });
  }
}

// As MAVLink's own definitions have them (common.xml); ours are computed from the layouts.
TEST(Mavlink, ChecksumsOfDefinitionsAreThePublishedOnes) {
  EXPECT_EQ(crc_extra_of<Heartbeat>(), 50);
  EXPECT_EQ(crc_extra_of<Attitude>(), 39);
  EXPECT_EQ(crc_extra_of<SetAttitudeTarget>(), 49);
  EXPECT_EQ(crc_extra_of<HighresImu>(), 93);
  EXPECT_EQ(crc_extra_of<CommandAck>(), 143);
  EXPECT_EQ(crc_extra_of<Odometry>(), 91);
  EXPECT_EQ(crc_extra(9999), std::nullopt);
}

TEST(Mavlink, ZerosAtTheEndAreNotSentButOneByteAlwaysIs) {
  Data out(kLongestFrame);
  EXPECT_EQ(encode_message(Attitude{}, {}, out), kHeader + 1 + kChecksum);
  EXPECT_EQ(encode_message(Attitude{.yawspeed = 1}, {}, out), kHeader + 28 + kChecksum);
  EXPECT_EQ(encode_message(CommandAck{.command = 400}, {}, out), kHeader + 2 + kChecksum);
  for (std::size_t room = 0; room < kHeader + 2 + kChecksum; ++room)
    EXPECT_EQ(encode_message(CommandAck{.command = 400}, {}, std::span{out}.first(room)), 0u);
}

Data some_frame(Rng& rng) {
  const auto& all = golden_frames();
  return all[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(all.size())))].frame;
}

TEST(MavlinkStream, FindsEveryFrameBetweenGarbage) {
  for_all(200, [](Rng& rng) {
    Data bytes;
    std::size_t garbage = 0;
    for (int i = 0; i < 5; ++i) {
      for (int n = rng.uniform_index(40); n > 0; --n, ++garbage)
        bytes.push_back(rng.uniform_index(3) == 0 ? 0xFD : static_cast<std::uint8_t>(rng.next()));
      // A beginning that claims what follows.
      if (rng.uniform_index(2) == 1)
        for (const int byte : {0xFD, 200, 0, 0, 1, 1, 1, 30, 0, 0})
          bytes.push_back(std::uint8_t(byte)), ++garbage;
      const Data frame = some_frame(rng);
      bytes.insert(bytes.end(), frame.begin(), frame.end());
    }
    bytes.insert(bytes.end(), Protocol::kLongest, 0);
    int frames = 0;
    Stream stream;
    stream.feed(bytes, [&](const Frame&) { ++frames; });
    EXPECT_EQ(frames, 5);
    EXPECT_EQ(stream.skipped(), garbage + Protocol::kLongest);
  });
}

TEST(MavlinkStream, AFlippedBitLosesTheFrameAndNoOther) {
  for_all(500, [](Rng& rng) {
    Data bytes = some_frame(rng);
    // Only the flag for a signature means anything, and it asks for more bytes.
    const auto at = static_cast<std::size_t>(rng.uniform_index(static_cast<int>(bytes.size())));
    bytes[at] ^= static_cast<std::uint8_t>(1 << rng.uniform_index(8));
    const Data good = golden_frames()[0].frame;
    bytes.insert(bytes.end(), good.begin(), good.end());
    bytes.insert(bytes.end(), Protocol::kLongest, 0);
    int frames = 0;
    Stream stream;
    stream.feed(bytes, [&](const Frame&) { ++frames; });
    EXPECT_EQ(frames, 1);
  });
}

TEST(MavlinkStream, ASignedFrameIsTakenWholeAndOneOfAnUnknownKindIsNot) {
  Data out(kLongestFrame);
  out.resize(encode_message(Attitude{.roll = 1}, {1, 1, 0}, out));
  out[2] = 1;  // signed: the checksum covers it
  const std::uint8_t extra = crc_extra_of<Attitude>();
  const std::uint16_t crc = link::crc16_of(
      Bytes{&extra, 1}, link::crc16_of(Bytes{out}.subspan(1, out.size() - 1 - kChecksum)));
  out[out.size() - 2] = static_cast<std::uint8_t>(crc);
  out[out.size() - 1] = static_cast<std::uint8_t>(crc >> 8);
  const Data signature(kSignature, 0xFD);
  out.insert(out.end(), signature.begin(), signature.end());
  int frames = 0;
  Stream stream;
  stream.feed(out, [&](const Frame& frame) { frames += message_in<Attitude>(frame) ? 1 : 0; });
  EXPECT_EQ(frames, 1);
  EXPECT_EQ(stream.skipped(), 0u);
  out[2] = 2;  // a flag that nobody knows
  Stream other;
  other.feed(out, [&](const Frame&) { ++frames; });
  EXPECT_EQ(frames, 1);
}

TEST(MavlinkStream, AMillionRandomBytesAreSurvived) {
  Rng rng{11};
  Stream stream;
  std::uint64_t in_frames = 0;
  for (int i = 0; i < 1000; ++i) {
    Data bytes(1000);
    for (std::uint8_t& byte : bytes)
      byte = rng.uniform_index(8) == 0 ? 0xFD : static_cast<std::uint8_t>(rng.uniform_index(40));
    stream.feed(bytes, [&](const Frame& frame) { in_frames += frame.payload.size(); });
  }
  EXPECT_LT(in_frames, 20'000u) << "frames by chance";
  const Data last = golden_frames()[10].frame;
  int found = 0;
  Data bytes = last;
  bytes.insert(bytes.end(), Protocol::kLongest, 0);
  stream.feed(bytes, [&](const Frame&) { ++found; });
  EXPECT_EQ(found, 1);
}

}  // namespace
}  // namespace gatefly::mavlink
