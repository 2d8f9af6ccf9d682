// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/interview.hpp"

#include <algorithm>

namespace gatefly::guard {
namespace {

constexpr std::array<std::uint16_t, 9> kQuestions{
    msp::FcVariant::kId,  msp::ApiVersion::kId, msp::RcTuning::kId,
    msp::RcDeadband::kId, msp::RxConfig::kId,   msp::RxMap::kId,
    msp::kBoxIds,         msp::kModeRanges,     msp::kStatus};

void note(DroneFacts& facts, std::uint16_t id, link::Bytes payload) {
  switch (id) {
    case msp::FcVariant::kId:
      facts.variant = link::decoded<msp::FcVariant>(payload);
      break;
    case msp::ApiVersion::kId:
      facts.api = link::decoded<msp::ApiVersion>(payload);
      break;
    case msp::RcTuning::kId:
      facts.tuning = link::decoded<msp::RcTuning>(payload);
      break;
    case msp::RcDeadband::kId:
      facts.deadband = link::decoded<msp::RcDeadband>(payload);
      break;
    case msp::RxConfig::kId:
      facts.receiver = link::decoded<msp::RxConfig>(payload);
      break;
    case msp::RxMap::kId:
      facts.map = link::decoded<msp::RxMap>(payload);
      break;
    case msp::kBoxIds:
      facts.boxes = msp::box_ids_in(payload);
      break;
    case msp::kModeRanges:
      facts.ranges = msp::mode_ranges_in(payload);
      break;
    case msp::kStatus:
      facts.status = msp::status_in(payload);
      break;
    default:
      break;
  }
}

/// The switch of a mode.
std::optional<msp::ModeRange> switch_of(const DroneFacts& facts, msp::Box box) {
  if (!facts.ranges) return std::nullopt;
  for (const msp::ModeRange& range : *facts.ranges)
    if (range.box == box) return range;
  return std::nullopt;
}

bool has(const DroneFacts& facts, msp::Box box) {
  return facts.boxes && std::find(facts.boxes->begin(), facts.boxes->end(),
                                  static_cast<std::uint8_t>(box)) != facts.boxes->end();
}

bool is_on(const DroneFacts& facts, msp::Box box) {
  return facts.boxes && facts.status && facts.status->on(box, *facts.boxes).value_or(false);
}

/// Reads MSP_STATUS.
void add_status(const DroneFacts& facts, Complaints& complaints) {
  if (!facts.status || !facts.boxes) {
    complaints.push_back(Complaint::kNoStatus);
    return;
  }
  if (!facts.status->gyro) complaints.push_back(Complaint::kNoGyro);
  if (!facts.status->accelerometer) complaints.push_back(Complaint::kNoAccelerometer);
  if (facts.status->bus_errors > 0) complaints.push_back(Complaint::kBusErrors);
  if (is_on(facts, msp::Box::kArm)) complaints.push_back(Complaint::kArmed);
}

void add_switches(const DroneFacts& facts, Complaints& complaints) {
  const auto arm = switch_of(facts, msp::Box::kArm);
  const auto override_switch = switch_of(facts, msp::Box::kMspOverride);
  if (!arm) complaints.push_back(Complaint::kNoArmSwitch);
  if (!has(facts, msp::Box::kMspOverride)) {
    complaints.push_back(Complaint::kNoOverride);
  } else if (!override_switch) {
    complaints.push_back(Complaint::kNoOverrideSwitch);
  }
  if (arm && override_switch && arm->aux == override_switch->aux)
    complaints.push_back(Complaint::kOneSwitchForBoth);
}

}  // namespace

std::optional<msp::RateProfile> DroneFacts::rates() const {
  if (!tuning || !deadband || !receiver) return std::nullopt;
  return msp::RateProfile::from(*tuning, *deadband, *receiver);
}

std::optional<msp::ThrottleCurve> DroneFacts::throttle() const {
  if (!tuning || !receiver) return std::nullopt;
  return msp::ThrottleCurve::from(*tuning, *receiver);
}

std::optional<msp::ChannelOrder> DroneFacts::order() const {
  return map ? msp::ChannelOrder::from(*map) : std::nullopt;
}

std::optional<std::uint16_t> Interview::question() const {
  if (asked_ == kQuestions.size()) return std::nullopt;
  return kQuestions[asked_];
}

void Interview::take(const msp::Frame& frame) {
  if (frame.id != question() || frame.direction == msp::Direction::kToController) return;
  if (frame.direction == msp::Direction::kFromController) note(facts_, frame.id, frame.payload);
  ++asked_;
}

void Interview::skip() { asked_ = std::min(asked_ + 1, kQuestions.size()); }

Complaints complaints_about(const DroneFacts& facts) {
  Complaints complaints;
  constexpr std::array<char, 4> kBetaflight{'B', 'T', 'F', 'L'};
  if (!facts.variant || facts.variant->name != kBetaflight)
    complaints.push_back(Complaint::kNotBetaflight);
  if (!facts.api || facts.api->major != 1 || facts.api->minor < 43)
    complaints.push_back(Complaint::kApi);
  if (!facts.rates()) complaints.push_back(Complaint::kRates);
  if (!facts.throttle()) complaints.push_back(Complaint::kThrottleCurve);
  if (!facts.order()) complaints.push_back(Complaint::kChannelOrder);
  add_status(facts, complaints);
  add_switches(facts, complaints);
  return complaints;
}

std::string_view text_of(Complaint complaint) {
  switch (complaint) {
    case Complaint::kNotBetaflight:
      return "the controller does not say that it is a Betaflight";
    case Complaint::kApi:
      return "MSP's API is not 1.43 or later";
    case Complaint::kRates:
      return "rates are of a type that is not known here: set rates_type = BETAFLIGHT or ACTUAL";
    case Complaint::kThrottleCurve:
      return "the throttle curve is of API 1.47 or later, or limited: not known here";
    case Complaint::kChannelOrder:
      return "the channel map does not have roll, pitch, throttle and yaw in its first four places";
    case Complaint::kNoGyro:
      return "there is no gyro";
    case Complaint::kNoAccelerometer:
      return "there is no accelerometer";
    case Complaint::kBusErrors:
      return "the sensors' bus has errors";
    case Complaint::kArmed:
      return "the drone is armed";
    case Complaint::kNoStatus:
      return "the controller does not tell its status and modes";
    case Complaint::kNoArmSwitch:
      return "no switch arms the drone";
    case Complaint::kNoOverride:
      return "there is no mode MSP OVERRIDE: it has to be built in, and msp_override_channels_mask "
             "set";
    case Complaint::kNoOverrideSwitch:
      return "no switch turns MSP OVERRIDE on";
    case Complaint::kOneSwitchForBoth:
      return "ARM and MSP OVERRIDE are on the same switch";
  }
  return "";
}

}  // namespace gatefly::guard
