// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/mavlink_listener.hpp"

namespace gatefly::live {

/// How that drone is asked, and when it obeys us.
[[nodiscard]] MavlinkListener::Params listener_params(const DroneFile& drone, double imu_hz);

/// MavlinkListener, and it flies: rates and thrust, with a question for the clock beside each, whose answer tells that it has arrived.
class MavlinkSpeaker : public MavlinkListener, public Speaker {
 public:
  /// @param drone  outlives it.
  MavlinkSpeaker(const DroneFile& drone, double imu_hz);
  [[nodiscard]] link::Bytes set_point(const Demand& demand, std::chrono::nanoseconds now) override;
  [[nodiscard]] msp::Sticks sticks(const Demand& demand) const override;

 private:
  [[nodiscard]] mavlink::SetAttitudeTarget target(const Demand& demand,
                                                  std::chrono::nanoseconds now) const;

  const DroneFile& drone_;
  std::array<std::uint8_t, 256> frame_{};
};

}  // namespace gatefly::live
