// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/ardu_interview.hpp"

namespace gatefly::guard {
namespace {

constexpr int kThrustAsThrust = 8;

void add_parameters(const ArduFacts& facts, ArduComplaints& complaints) {
  if (!facts.has_all_parameters()) {
    complaints.push_back(ArduComplaint::kNoParameters);
    return;
  }
  const auto options = static_cast<int>(*facts.parameter(ArduParameter::kGuidedOptions));
  if ((options & kThrustAsThrust) == 0) complaints.push_back(ArduComplaint::kThrustIsClimbRate);
  const float timeout = *facts.parameter(ArduParameter::kGuidedTimeout);
  if (!(timeout > 0.0f && timeout <= kLongestHold)) complaints.push_back(ArduComplaint::kTimeout);
  const float hover = *facts.parameter(ArduParameter::kHoverThrust);
  if (!(hover >= 0.05f && hover <= 0.8f)) complaints.push_back(ArduComplaint::kNoHover);
}

}  // namespace

ArduComplaints complaints_about(const ArduFacts& facts) {
  ArduComplaints complaints;
  if (!facts.heartbeat || facts.heartbeat->autopilot != mavlink::Heartbeat::kArduPilot) {
    complaints.push_back(ArduComplaint::kNotArduPilot);
    return complaints;
  }
  if (!facts.is_multicopter()) complaints.push_back(ArduComplaint::kNoMulticopter);
  if (!facts.version) complaints.push_back(ArduComplaint::kNoVersion);
  add_parameters(facts, complaints);
  if (!facts.gyro_works()) complaints.push_back(ArduComplaint::kNoGyro);
  if (!facts.accelerometer_works()) complaints.push_back(ArduComplaint::kNoAccelerometer);
  if (facts.armed()) complaints.push_back(ArduComplaint::kArmed);
  return complaints;
}

std::string_view text_of(ArduComplaint complaint) {
  switch (complaint) {
    case ArduComplaint::kNotArduPilot:
      return "the controller does not say that it is an ArduPilot";
    case ArduComplaint::kNoMulticopter:
      return "the controller does not say that it is a multicopter";
    case ArduComplaint::kNoVersion:
      return "the controller does not tell its version";
    case ArduComplaint::kNoParameters:
      return "the controller does not tell all parameters that a set point's effect depends on";
    case ArduComplaint::kThrustIsClimbRate:
      return "it takes thrust for a rate of climb: set bit 3 of GUID_OPTIONS (8)";
    case ArduComplaint::kTimeout:
      return "it holds on to the last set point for too long: set GUID_TIMEOUT = 1";
    case ArduComplaint::kNoHover:
      return "MOT_THST_HOVER is not within 0.05 to 0.8: let it hover by hand, or set it";
    case ArduComplaint::kNoGyro:
      return "there is no gyro that works";
    case ArduComplaint::kNoAccelerometer:
      return "there is no accelerometer that works";
    case ArduComplaint::kArmed:
      return "the drone is armed";
  }
  return "";
}

}  // namespace gatefly::guard
