// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/link/bytes.hpp"

// MSP's messages whose length is their own. All are read without allocating; what is longer than we
// have room for is refused, not cut.

namespace gatefly::msp {

using link::Bytes;

inline constexpr std::uint16_t kModeRanges = 34;       ///< MSP_MODE_RANGES
inline constexpr std::uint16_t kStatus = 101;          ///< MSP_STATUS
inline constexpr std::uint16_t kRc = 105;              ///< MSP_RC
inline constexpr std::uint16_t kBoxNames = 116;        ///< MSP_BOXNAMES
inline constexpr std::uint16_t kBoxIds = 119;          ///< MSP_BOXIDS
inline constexpr std::uint16_t kStatusEx = 150;        ///< MSP_STATUS_EX
inline constexpr std::uint16_t kSetRawRc = 200;        ///< MSP_SET_RAW_RC
inline constexpr std::uint16_t kAccCalibration = 205;  ///< MSP_ACC_CALIBRATION
inline constexpr std::uint16_t kMultiple = 230;        ///< MSP_MULTIPLE_MSP

inline constexpr std::size_t kMostChannels = 18;
using Channels = FixedList<std::uint16_t, kMostChannels>;  ///< [µs]

/// MSP_RC: what the controller flies by, u16 each: roll, pitch, **yaw, throttle**, AUX1 …
[[nodiscard]] std::optional<Channels> channels_in(Bytes payload);

/// A mode of Betaflight by the number that it keeps in every version.
enum class Box : std::uint8_t {
  kArm = 0,
  kAngle = 1,
  kHorizon = 2,
  kFailsafe = 27,
  kMspOverride = 50
};

inline constexpr std::size_t kMostBoxes = 128;
using BoxIds = FixedList<std::uint8_t, kMostBoxes>;

/// MSP_BOXIDS: the modes that this controller has, u8 each; a mode's place is its bit in MSP_STATUS.
[[nodiscard]] std::optional<BoxIds> box_ids_in(Bytes payload);

/// MSP_BOXNAMES: the `index`th name, each ends with ';'; empty when there are not so many.
[[nodiscard]] std::string_view box_name_in(Bytes payload, std::size_t index);

/// A mode is on while its channel is within the range.
struct ModeRange {
  Box box = Box::kArm;
  std::uint8_t aux = 0;                   ///< 0 is AUX1, the fifth channel.
  std::uint16_t from = 900, below = 900;  ///< [µs]; sent in steps of 25 from 900.
  [[nodiscard]] bool used() const { return from < below; }
  [[nodiscard]] bool holds(std::uint16_t channel) const {
    return from <= channel && channel < below;
  }
};

using ModeRanges = FixedList<ModeRange, 40>;

/// MSP_MODE_RANGES, four bytes each; those that are not used are left out.
[[nodiscard]] std::optional<ModeRanges> mode_ranges_in(Bytes payload);

/// MSP_STATUS and MSP_STATUS_EX.
struct Status {
  std::uint16_t cycle_time_us = 0, bus_errors = 0;
  bool accelerometer = false, barometer = false, gyro = false;
  std::bitset<kMostBoxes> modes;  ///< By place in MSP_BOXIDS.
  std::uint16_t load_percent = 0;
  std::uint32_t arming_refused = 0;  ///< A bit for each reason; 0: it can be armed, or is.
  /// Whether a mode is on; nullopt when the controller does not have it.
  [[nodiscard]] std::optional<bool> on(Box box, const BoxIds& ids) const;
};

/// u16 cycle time, bus errors, sensors; u32 modes; u8 profile; u16 load; 2 bytes; u8 n, n bytes of modes; u8, u32 arming.
[[nodiscard]] std::optional<Status> status_in(Bytes payload);

/// MSP_MULTIPLE_MSP asks for several messages of ids below 256 in one frame: its payload are their ids.
/// Calls on_answer(id, payload) for each of `ids` that is answered in `payload`, in their order: u8 size and
/// as many bytes each. False when the bytes do not come out even; what came before has been called.
/// A controller whose buffer is full answers the first ones only.
template <class OnAnswer>
bool each_answer(std::span<const std::uint8_t> ids, Bytes payload, OnAnswer&& on_answer) {
  link::ByteReader in{payload};
  for (const std::uint8_t id : ids) {
    if (in.rest().empty()) return true;
    const auto size = in.take<std::uint8_t>();
    const Bytes answer = in.take_bytes(size);
    if (!in.complete()) return false;
    on_answer(std::uint16_t{id}, answer);
  }
  return in.rest().empty();
}

}  // namespace gatefly::msp
