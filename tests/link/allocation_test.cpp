// SPDX-License-Identifier: Apache-2.0
// Nothing is allocated where bytes are read and written.
#include <array>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/link/ardupilot_json.hpp"
#include "gatefly/link/jpeg_slices.hpp"
#include "gatefly/link/mavlink.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"

#include "support/allocation_counter.hpp"

namespace gatefly {
namespace {

TEST(LinkAllocation, NoneForFrames) {
  test::expect_that_allocations_are_counted();
  msp::Stream msp_stream;
  mavlink::Stream mavlink_stream;
  int messages = 0;
  const test::NothingAllocated nothing;
  std::array<std::uint8_t, 512> out{};
  std::size_t size = msp::encode_message(msp::RcTuning{}, msp::Direction::kFromController, out);
  msp_stream.feed(link::Bytes{out}.first(size), [&](const msp::Frame& frame) {
    messages += link::decoded<msp::RcTuning>(frame.payload) ? 1 : 0;
    messages += msp::status_in(frame.payload) ? 1 : 0;
  });
  size = mavlink::encode_message(mavlink::Odometry{.quality = 3}, {}, out);
  mavlink_stream.feed(link::Bytes{out}.first(size), [&](const mavlink::Frame& frame) {
    messages += mavlink::message_in<mavlink::Odometry>(frame) ? 1 : 0;
  });
  EXPECT_EQ(messages, 3);
}

TEST(LinkAllocation, NoneForLinesOfText) {
  std::array<char, ardupilot::kLongestLine> out{};
  const test::NothingAllocated nothing;
  EXPECT_GT(ardupilot::encode_state({.p_EB = {1.0 / 3, 2e-300, 3e300}}, out), 0u);
}

TEST(LinkAllocation, NoneForPicturesOnceTheirPlaceIsThere) {
  const std::vector<std::uint8_t> jpeg(30'000, 7);
  std::array<std::uint8_t, 1024> room{};
  jpeg_slices::Assembler assembler;
  int pictures = 0;
  const test::NothingAllocated nothing;
  jpeg_slices::each_slice(jpeg, 1, {}, room, [&](link::Bytes datagram) {
    pictures += assembler.take(datagram) ? 1 : 0;
  });
  EXPECT_EQ(pictures, 1);
}

}  // namespace
}  // namespace gatefly
