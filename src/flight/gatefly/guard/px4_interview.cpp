// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/px4_interview.hpp"

namespace gatefly::guard {
namespace {

constexpr float kLands = 4.0f;               ///< A value of COM_OBL_RC_ACT.
constexpr int kLearnsAccelerometerBias = 2;  ///< A bit of EKF2_IMU_CTRL.

void add_parameters(const Px4Facts& facts, Px4Complaints& complaints) {
  if (!facts.has_all_parameters()) {
    complaints.push_back(Px4Complaint::kNoParameters);
    return;
  }
  const float timeout = *facts.parameter(Px4Parameter::kOffboardTimeout);
  if (!(timeout > 0.0f && timeout <= kLongestHold)) complaints.push_back(Px4Complaint::kTimeout);
  if (facts.parameter(Px4Parameter::kOffboardLoss) != kLands)
    complaints.push_back(Px4Complaint::kDoesNotLand);
  const float hover = *facts.parameter(Px4Parameter::kHoverThrust);
  if (!(hover >= 0.05f && hover <= 0.8f)) complaints.push_back(Px4Complaint::kNoHover);
  const auto imu_control = static_cast<int>(*facts.parameter(Px4Parameter::kImuControl));
  if ((imu_control & kLearnsAccelerometerBias) != 0) complaints.push_back(Px4Complaint::kBiasMoves);
}

}  // namespace

Px4Complaints complaints_about(const Px4Facts& facts) {
  Px4Complaints complaints;
  if (!facts.heartbeat || facts.heartbeat->autopilot != mavlink::Heartbeat::kPx4) {
    complaints.push_back(Px4Complaint::kNotPx4);
    return complaints;
  }
  if (!facts.is_multicopter()) complaints.push_back(Px4Complaint::kNoMulticopter);
  if (!facts.version) complaints.push_back(Px4Complaint::kNoVersion);
  add_parameters(facts, complaints);
  if (!facts.gyro_works()) complaints.push_back(Px4Complaint::kNoGyro);
  // 1.14 calls no accelerometer present, only well: it takes one that it finds for a gyro.
  if (!facts.is_healthy(Px4Facts::kAccelerometer))
    complaints.push_back(Px4Complaint::kNoAccelerometer);
  if (facts.armed()) complaints.push_back(Px4Complaint::kArmed);
  return complaints;
}

std::string_view text_of(Px4Complaint complaint) {
  switch (complaint) {
    case Px4Complaint::kNotPx4:
      return "the controller does not say that it is a PX4";
    case Px4Complaint::kNoMulticopter:
      return "the controller does not say that it is a multicopter";
    case Px4Complaint::kNoVersion:
      return "the controller does not tell its version";
    case Px4Complaint::kNoParameters:
      return "the controller does not tell all parameters that a set point's effect depends on";
    case Px4Complaint::kTimeout:
      return "it holds on to the last set point for too long: set COM_OF_LOSS_T = 0.5";
    case Px4Complaint::kDoesNotLand:
      return "without set points it must land where it is, Return would climb: set COM_OBL_RC_ACT "
             "= 4";
    case Px4Complaint::kNoHover:
      return "MPC_THR_HOVER is not within 0.05 to 0.8: let it hover by hand, or set it";
    case Px4Complaint::kBiasMoves:
      return "what it tells of its accelerometer changes as its filter learns a bias: set "
             "EKF2_IMU_CTRL = 1";
    case Px4Complaint::kNoGyro:
      return "there is no gyro that works";
    case Px4Complaint::kNoAccelerometer:
      return "there is no accelerometer that works";
    case Px4Complaint::kArmed:
      return "the drone is armed";
  }
  return "";
}

}  // namespace gatefly::guard
