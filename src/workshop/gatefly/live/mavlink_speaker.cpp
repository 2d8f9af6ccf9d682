// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/mavlink_speaker.hpp"

#include <cmath>

#include "gatefly/geometry/seconds.hpp"
#include "gatefly/link/mavlink_axes.hpp"

namespace gatefly::live {

MavlinkListener::Params listener_params(const DroneFile& drone, double imu_hz) {
  MavlinkListener::Params params;
  params.system = drone.system();
  params.imu_hz = imu_hz;
  params.px4 = drone.px4.has_value();
  params.ts002 = drone.ts002.has_value();
  return params;
}

MavlinkSpeaker::MavlinkSpeaker(const DroneFile& drone, double imu_hz)
    : MavlinkListener{listener_params(drone, imu_hz)}, drone_{drone} {}

mavlink::SetAttitudeTarget MavlinkSpeaker::target(const Demand& demand,
                                                  std::chrono::nanoseconds now) const {
  const auto since = std::chrono::duration_cast<std::chrono::milliseconds>(now);
  const mavlink::Target drone{static_cast<std::uint8_t>(drone_.system()), MavlinkWords::kAutopilot};
  if (demand.rests) return mavlink::rate_target(drone, Eigen::Vector3d::Zero(), 0.0, since);
  const gatefly::Attitude& is = state().attitude;
  return mavlink::rate_target(
      drone, demand.rates_B,
      drone_.thrust_part(demand.thrust, std::cos(is.roll) * std::cos(is.pitch)), since);
}

msp::Sticks MavlinkSpeaker::sticks(const Demand& demand) const {
  return mavlink_sticks(target(demand, std::chrono::nanoseconds{0}));
}

link::Bytes MavlinkSpeaker::set_point(const Demand& demand, std::chrono::nanoseconds now) {
  link::ByteWriter out{frame_};
  words().set_point(out, target(demand, now));
  ask_clock(out, now, true);
  return out.written();
}

}  // namespace gatefly::live
