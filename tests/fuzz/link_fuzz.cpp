// SPDX-License-Identifier: Apache-2.0
// Any bytes come from an autopilot or a camera. The first one says which decoder they go to; it may refuse
// them, but what it takes must be as its header says, and what is written again must be what was read.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <tuple>
#include <vector>

#include "gatefly/link/ardupilot_json.hpp"
#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/link/jpeg_slices.hpp"
#include "gatefly/link/mavlink.hpp"
#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_hil.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"

namespace {

using namespace gatefly;
using link::Bytes;

void must(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "link_fuzz: %s\n", what);
  std::abort();
}

/// An allocation of exactly these bytes, so that a sanitizer sees the first one too many.
std::vector<std::uint8_t> exactly(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

template <class Message>
void try_message(Bytes payload) {
  const auto message = link::decoded<Message>(payload);
  must(message.has_value() == (payload.size() >= link::sizes_of<Message>().least()),
       "a message of fixed layout is read if, and only if, it is long enough");
  if (!message) return;
  std::array<std::uint8_t, 1024> room{};
  link::ByteWriter out{room};
  link::encode(*message, out);
  const std::size_t same = std::min(out.size(), payload.size());
  must(std::equal(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(same),
                  room.begin()) ||
           payload.size() < link::sizes_of<Message>().all(),
       "what is read is written again as it was");
}

template <class... Message>
void try_messages(Bytes payload, const std::tuple<Message...>*) {
  (try_message<Message>(payload), ...);
}

void try_curves(Bytes payload) {
  const auto tuning = link::decoded<msp::RcTuning>(payload);
  if (!tuning) return;
  const msp::RxConfig receiver{.mid = 1500, .min_check = 1050};
  if (const auto profile =
          msp::RateProfile::from(*tuning, {.roll_and_pitch = payload[0]}, receiver)) {
    for (int stick = 1000; stick <= 2000; stick += 37) {
      const double rate = profile->roll.rate(stick);
      must(std::isfinite(rate), "a rate is a number");
      must(profile->roll.rate(profile->roll.stick(rate)) == rate, "a rate comes back");
    }
  }
  if (const auto curve = msp::ThrottleCurve::from(*tuning, receiver))
    for (int stick = 1000; stick <= 2000; stick += 37)
      must(curve->throttle(curve->stick(curve->throttle(stick))) >= curve->throttle(stick),
           "a throttle comes back");
}

void try_msp_payload(Bytes payload) {
  try_messages(payload, static_cast<const msp::Messages*>(nullptr));
  try_curves(payload);
  (void)msp::channels_in(payload);
  (void)msp::mode_ranges_in(payload);
  for (std::size_t i = 0; i < 5; ++i) (void)msp::box_name_in(payload, i);
  const auto ids = msp::box_ids_in(payload);
  const auto status = msp::status_in(payload);
  if (ids && status) (void)status->on(msp::Box::kMspOverride, *ids);
  if (const auto map = link::decoded<msp::RxMap>(payload))
    if (const auto order = msp::ChannelOrder::from(*map))
      must(order->set_raw_rc({1, 2, 3, 4}) != order->set_raw_rc({1, 2, 4, 3}), "an order is one");
  if (const auto raw = link::decoded<msp::RawImu>(payload))
    must(msp::imu_of(*raw, {}).gyro_B.allFinite(), "an IMU's sample is a number");
  if (!payload.empty())
    msp::each_answer(payload.first(payload.size() / 4), payload.subspan(payload.size() / 4),
                     [](std::uint16_t, Bytes answer) { (void)msp::status_in(answer); });
}

void try_msp(Bytes bytes) {
  msp::Stream stream;
  std::size_t in_frames = 0;
  stream.feed(bytes, [&](const msp::Frame& frame) {
    must(frame.payload.size() <= msp::kMostPayload, "a payload is not too long");
    std::array<std::uint8_t, msp::kMostPayload + msp::kFrameOverhead> out{};
    in_frames += msp::encode_frame(frame, out);
    try_msp_payload(exactly(frame.payload));
  });
  must(in_frames <= bytes.size() && stream.skipped() <= bytes.size(), "no byte is counted twice");
}

template <class... Message>
void try_mavlink_messages(const mavlink::Frame& frame, const std::tuple<Message...>*) {
  const auto again = [&]<class M>(const std::optional<M>& message) {
    std::array<std::uint8_t, mavlink::kLongestFrame> out{};
    if (message)
      must(mavlink::encode_message(*message, frame.sender, out) > 0, "what is read can be written");
  };
  (again(mavlink::message_in<Message>(frame)), ...);
}

using AllMavlink =
    decltype(std::tuple_cat(mavlink::Telemetry{}, mavlink::Commands{}, mavlink::HardwareInLoop{}));

void try_mavlink(Bytes bytes) {
  mavlink::Stream stream;
  stream.feed(bytes, [&](const mavlink::Frame& frame) {
    try_mavlink_messages(frame, static_cast<const AllMavlink*>(nullptr));
    if (const auto sync = mavlink::message_in<mavlink::Timesync>(frame))
      (void)mavlink::clock_offset(*sync, std::chrono::nanoseconds{1'000'000'000});
  });
  must(stream.skipped() <= bytes.size(), "no byte is counted twice");
}

void try_datagrams(Bytes bytes) {
  (void)ardupilot::servos_in(bytes);
  (void)betaflight_sitl::motors_in(bytes);
  (void)betaflight_sitl::raw_servos_in(bytes);
}

/// Datagrams of a length that a byte before each says.
void try_slices(Bytes bytes) {
  static const jpeg_slices::AssemblerParams kSmall{
      .pictures = 2, .most_bytes = 64, .most_chunks = 5};
  jpeg_slices::Assembler assembler{kSmall};
  link::ByteReader in{bytes};
  while (!in.rest().empty()) {
    const std::size_t size = in.take<std::uint8_t>() % 64;
    const auto datagram = exactly(in.take_bytes(size));
    if (const auto picture = assembler.take(datagram))
      must(!picture->jpeg.empty() && picture->jpeg.size() <= kSmall.most_bytes, "a picture fits");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = exactly(Bytes{data, size}.subspan(1));
  switch (data[0] % 5) {
    case 0:
      try_msp(bytes);
      break;
    case 1:
      try_msp_payload(bytes);
      break;
    case 2:
      try_mavlink(bytes);
      break;
    case 3:
      try_datagrams(bytes);
      break;
    default:
      try_slices(bytes);
  }
  return 0;
}
