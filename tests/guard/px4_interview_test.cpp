// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/px4_interview.hpp"

#include <cmath>
#include <functional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gatefly::guard {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<Px4Complaint> about(const Px4Facts& facts) {
  const Px4Complaints complaints = complaints_about(facts);
  return {complaints.begin(), complaints.end()};
}

/// As 1.14 answers: of its accelerometer it says that it is well, and not that it is there.
Px4Facts healthy_px4() {
  Px4Facts facts;
  facts.heartbeat = mavlink::Heartbeat{.type = 2, .autopilot = 12, .base_mode = 29};
  facts.version = mavlink::AutopilotVersion{.flight_sw_version = 0x010E00FF};
  facts.sensors =
      mavlink::SysStatus{.onboard_control_sensors_present = 1, .onboard_control_sensors_health = 3};
  facts.parameters = {0.5f, 4.0f, 0.3f, 1.0f, 1.0f};
  return facts;
}

TEST(Px4Interview, OfAHealthyDroneNothingIsComplainedAbout) {
  EXPECT_THAT(about(healthy_px4()), IsEmpty());
}

TEST(Px4Interview, EachFaultIsNamedAndNoOther) {
  using Complaint = Px4Complaint;
  const auto set = [](Px4Parameter which, float value) {
    return [=](Px4Facts& facts) { facts.parameters[static_cast<std::size_t>(which)] = value; };
  };
  struct Case {
    Complaint complaint;
    std::function<void(Px4Facts&)> fault;
  };
  const std::vector<Case> cases{
      {Complaint::kNotPx4, [](Px4Facts& f) { f.heartbeat->autopilot = 3; }},
      {Complaint::kNotPx4, [](Px4Facts& f) { f.heartbeat.reset(); }},
      {Complaint::kNoMulticopter, [](Px4Facts& f) { f.heartbeat->type = 1; }},
      {Complaint::kNoVersion, [](Px4Facts& f) { f.version.reset(); }},
      {Complaint::kNoParameters, [](Px4Facts& f) { f.parameters[2].reset(); }},
      {Complaint::kTimeout, set(Px4Parameter::kOffboardTimeout, 1.5f)},
      {Complaint::kTimeout, set(Px4Parameter::kOffboardTimeout, 0.0f)},
      {Complaint::kTimeout, set(Px4Parameter::kOffboardTimeout, NAN)},
      {Complaint::kDoesNotLand, set(Px4Parameter::kOffboardLoss, 3.0f)},
      {Complaint::kDoesNotLand, set(Px4Parameter::kOffboardLoss, 0.0f)},
      {Complaint::kNoHover, set(Px4Parameter::kHoverThrust, 0.9f)},
      {Complaint::kNoHover, set(Px4Parameter::kHoverThrust, NAN)},
      {Complaint::kBiasMoves, set(Px4Parameter::kImuControl, 3.0f)},
      {Complaint::kNoGyro, [](Px4Facts& f) { f.sensors->onboard_control_sensors_health = 2; }},
      {Complaint::kNoGyro, [](Px4Facts& f) { f.sensors->onboard_control_sensors_present = 0; }},
      {Complaint::kNoAccelerometer,
       [](Px4Facts& f) { f.sensors->onboard_control_sensors_health = 1; }},
      {Complaint::kArmed, [](Px4Facts& f) { f.heartbeat->base_mode = 157; }}};
  for (const Case& each : cases) {
    Px4Facts facts = healthy_px4();
    each.fault(facts);
    EXPECT_THAT(about(facts), ElementsAre(each.complaint)) << text_of(each.complaint);
    EXPECT_FALSE(text_of(each.complaint).empty());
  }
}

}  // namespace
}  // namespace gatefly::guard
