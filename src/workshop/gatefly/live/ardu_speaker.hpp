// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "gatefly/live/ardu_listener.hpp"
#include "gatefly/live/drone_file.hpp"

namespace gatefly::live {

/// How that drone is asked.
[[nodiscard]] ArduListener::Params ardu_params(const DroneFile& drone, double imu_hz);

/// ArduListener, and it flies: rates and thrust, with a question for the clock beside each, whose answer tells that it has arrived.
class ArduSpeaker : public ArduListener, public Speaker {
 public:
  /// @param drone  outlives it.
  ArduSpeaker(const DroneFile& drone, double imu_hz);
  [[nodiscard]] link::Bytes set_point(const Demand& demand, std::chrono::nanoseconds now) override;
  [[nodiscard]] msp::Sticks sticks(const Demand& demand) const override;

 private:
  [[nodiscard]] mavlink::SetAttitudeTarget target(const Demand& demand,
                                                  std::chrono::nanoseconds now) const;

  const DroneFile& drone_;
  std::array<std::uint8_t, 256> frame_{};
};

}  // namespace gatefly::live
