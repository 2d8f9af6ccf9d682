// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/ardu_speaker.hpp"

#include <cmath>

#include "gatefly/geometry/seconds.hpp"
#include "gatefly/link/mavlink_axes.hpp"

namespace gatefly::live {

ArduListener::Params ardu_params(const DroneFile& drone, double imu_hz) {
  ArduListener::Params params;
  params.system = drone.ardu->system;
  params.imu_hz = imu_hz;
  return params;
}

ArduSpeaker::ArduSpeaker(const DroneFile& drone, double imu_hz)
    : ArduListener{ardu_params(drone, imu_hz)}, drone_{drone} {}

mavlink::SetAttitudeTarget ArduSpeaker::target(const Demand& demand,
                                               std::chrono::nanoseconds now) const {
  const auto since = std::chrono::duration_cast<std::chrono::milliseconds>(now);
  const mavlink::Target drone{static_cast<std::uint8_t>(drone_.ardu->system),
                              ArduWords::kAutopilot};
  if (demand.rests) return mavlink::rate_target(drone, Eigen::Vector3d::Zero(), 0.0, since);
  const gatefly::Attitude& is = state().attitude;
  return mavlink::rate_target(drone, demand.rates_B,
                              drone_.ardu->thrust_part(drone_.hover.throttle_for(demand.thrust),
                                                       std::cos(is.roll) * std::cos(is.pitch)),
                              since);
}

msp::Sticks ArduSpeaker::sticks(const Demand& demand) const {
  return ardu_sticks(target(demand, std::chrono::nanoseconds{0}));
}

link::Bytes ArduSpeaker::set_point(const Demand& demand, std::chrono::nanoseconds now) {
  link::ByteWriter out{frame_};
  words().set_point(out, target(demand, now));
  ask_clock(out, now, true);
  return out.written();
}

}  // namespace gatefly::live
