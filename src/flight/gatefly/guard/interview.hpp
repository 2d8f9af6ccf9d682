// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"

namespace gatefly::guard {

/// A Betaflight's answers about itself; an answer that did not come is absent.
struct DroneFacts {
  std::optional<msp::FcVariant> variant;
  std::optional<msp::ApiVersion> api;
  std::optional<msp::RcTuning> tuning;
  std::optional<msp::RcDeadband> deadband;
  std::optional<msp::RxConfig> receiver;
  std::optional<msp::RxMap> map;
  std::optional<msp::BoxIds> boxes;
  std::optional<msp::ModeRanges> ranges;
  std::optional<msp::Status> status;

  [[nodiscard]] std::optional<msp::RateProfile> rates() const;
  [[nodiscard]] std::optional<msp::ThrottleCurve> throttle() const;
  [[nodiscard]] std::optional<msp::ChannelOrder> order() const;
};

/// Asks a controller for every constant that a program may not guess, one question after the other.
class Interview {
 public:
  /// The message to ask for now; nullopt when all have been answered or refused. Ask again when no answer comes.
  [[nodiscard]] std::optional<std::uint16_t> question() const;
  /// Takes a frame; any other than the answer to question() is left alone.
  void take(const msp::Frame& frame);
  /// Gives up on a question that is never answered.
  void skip();
  [[nodiscard]] const DroneFacts& facts() const { return facts_; }

 private:
  std::size_t asked_ = 0;
  DroneFacts facts_;
};

/// Reasons why this program must not fly a drone.
enum class Complaint : std::uint8_t {
  kNotBetaflight,
  kApi,
  kRates,
  kThrottleCurve,
  kChannelOrder,
  kNoGyro,
  kNoAccelerometer,
  kBusErrors,
  kArmed,
  kNoStatus,
  kNoArmSwitch,
  kNoOverride,
  kNoOverrideSwitch,
  kOneSwitchForBoth,
};
using Complaints = FixedList<Complaint, 16>;

/// In the order in which they are to be seen to; none: everything is known that has to be.
[[nodiscard]] Complaints complaints_about(const DroneFacts& facts);

/// For the line that a user reads.
[[nodiscard]] std::string_view text_of(Complaint complaint);

}  // namespace gatefly::guard
