// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/msp_speaker.hpp"

#include "gatefly/link/msp.hpp"

namespace gatefly::live {

MspPoller::Params poller_params(const DroneFile& drone) {
  /// Part of the hover's throttle that a pilot who stands does not give.
  constexpr double kLiftingPart = 0.8;
  MspPoller::Params params;
  params.lifting_stick =
      drone.throttle.stick(static_cast<int>(kLiftingPart * drone.hover.throttle));
  return params;
}

MspSpeaker::MspSpeaker(const DroneFile& drone, const msp::BoxIds& boxes)
    : MspPoller{drone.imu, boxes, poller_params(drone)}, drone_{drone} {}

msp::Sticks MspSpeaker::sticks(const Demand& demand) const {
  return demand.rests ? msp::kNeutral : drone_.sticks(demand.rates_B, demand.thrust);
}

link::Bytes MspSpeaker::set_point(const Demand& demand, std::chrono::nanoseconds) {
  const auto payload = drone_.order.set_raw_rc(sticks(demand));
  const std::size_t size = msp::encode_frame(
      {msp::kSetRawRc, payload, msp::Direction::kToController, msp::Version::k1}, frame_);
  sticks_sent();
  return {frame_.data(), size};
}

}  // namespace gatefly::live
