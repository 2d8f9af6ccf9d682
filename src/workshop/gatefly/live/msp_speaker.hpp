// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/msp_poller.hpp"

namespace gatefly::live {

/// MspPoller, and it moves the sticks.
class MspSpeaker : public MspPoller, public Speaker {
 public:
  /// @param drone  outlives it.
  MspSpeaker(const DroneFile& drone, const msp::BoxIds& boxes);
  [[nodiscard]] link::Bytes set_point(const Demand& demand, std::chrono::nanoseconds now) override;
  [[nodiscard]] msp::Sticks sticks(const Demand& demand) const override;

 private:
  const DroneFile& drone_;
  std::array<std::uint8_t, 32> frame_{};
};

/// How a drone is asked for what a pilot needs.
[[nodiscard]] MspPoller::Params poller_params(const DroneFile& drone);

}  // namespace gatefly::live
