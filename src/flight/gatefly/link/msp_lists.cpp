// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/msp_lists.hpp"

#include <algorithm>

namespace gatefly::msp {
namespace {

constexpr std::uint16_t kFirstStep = 900, kStep = 25;  ///< [µs]
constexpr unsigned kAccelerometerBit = 0, kBarometerBit = 1, kGyroBit = 5;

bool has(std::uint16_t bits, unsigned bit) { return ((bits >> bit) & 1u) != 0; }

void set_modes(std::bitset<kMostBoxes>& modes, std::size_t first, Bytes bytes) {
  for (std::size_t i = 0; i < 8 * bytes.size() && first + i < modes.size(); ++i)
    modes[first + i] = ((bytes[i / 8] >> (i % 8)) & 1u) != 0;
}

}  // namespace

std::optional<Channels> channels_in(Bytes payload) {
  if (payload.size() % 2 != 0 || payload.size() / 2 > kMostChannels) return std::nullopt;
  Channels channels;
  link::ByteReader in{payload};
  // At most kMostChannels times.
  while (!in.rest().empty()) channels.push_back(in.take<std::uint16_t>());
  return channels;
}

std::optional<BoxIds> box_ids_in(Bytes payload) {
  if (payload.size() > kMostBoxes) return std::nullopt;
  BoxIds ids;
  for (const std::uint8_t id : payload) ids.push_back(id);
  return ids;
}

std::string_view box_name_in(Bytes payload, std::size_t index) {
  auto begin = payload.begin();
  // At most once more than there are bytes: each time it begins behind a semicolon.
  while (true) {
    const auto end = std::find(begin, payload.end(), ';');
    if (end == payload.end()) return {};
    if (index-- == 0) {
      const auto first = static_cast<std::size_t>(begin - payload.begin());
      // Bytes may be looked at as characters.
      return {reinterpret_cast<const char*>(payload.data()) + first,
              static_cast<std::size_t>(end - begin)};
    }
    begin = end + 1;
  }
}

std::optional<ModeRanges> mode_ranges_in(Bytes payload) {
  constexpr std::size_t kEach = 4;
  if (payload.size() % kEach != 0 || payload.size() / kEach > ModeRanges::kCapacity)
    return std::nullopt;
  ModeRanges ranges;
  link::ByteReader in{payload};
  const auto step = [&] {
    return static_cast<std::uint16_t>(kFirstStep + kStep * in.take<std::uint8_t>());
  };
  // At most once for four bytes.
  while (!in.rest().empty()) {
    ModeRange range;
    range.box = static_cast<Box>(in.take<std::uint8_t>());
    range.aux = in.take<std::uint8_t>();
    range.from = step();
    range.below = step();
    if (range.used()) ranges.push_back(range);
  }
  return ranges;
}

std::optional<bool> Status::on(Box box, const BoxIds& ids) const {
  const auto found = std::find(ids.begin(), ids.end(), static_cast<std::uint8_t>(box));
  if (found == ids.end()) return std::nullopt;
  return modes[static_cast<std::size_t>(found - ids.begin())];
}

std::optional<Status> status_in(Bytes payload) {
  link::ByteReader in{payload};
  Status status;
  status.cycle_time_us = in.take<std::uint16_t>();
  status.bus_errors = in.take<std::uint16_t>();
  const auto sensors = in.take<std::uint16_t>();
  status.accelerometer = has(sensors, kAccelerometerBit);
  status.barometer = has(sensors, kBarometerBit);
  status.gyro = has(sensors, kGyroBit);
  set_modes(status.modes, 0, in.take_bytes(4));
  (void)in.take<std::uint8_t>();  // PID profile
  status.load_percent = in.take<std::uint16_t>();
  (void)in.take<std::uint16_t>();  // MSP_STATUS: nothing; MSP_STATUS_EX: profiles
  const auto more = in.take<std::uint8_t>();
  set_modes(status.modes, 32, in.take_bytes(more & 0x0Fu));
  (void)in.take<std::uint8_t>();  // how many reasons this version knows
  status.arming_refused = in.take<std::uint32_t>();
  if (!in.complete()) return std::nullopt;
  return status;
}

}  // namespace gatefly::msp
