// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/control/control_params.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/race/guidance.hpp"
#include "gatefly/race/lookout.hpp"
#include "gatefly/race/phase.hpp"
#include "gatefly/race/pilot_config.hpp"

namespace gatefly {

// The parameters of each part of a pilot, taken from its configuration.
[[nodiscard]] NavigatorParams navigator_params(const PilotConfig& config);
[[nodiscard]] LookoutParams lookout_params(const PilotConfig& config);
[[nodiscard]] GuidanceParams guidance_params(const PilotConfig& config);
[[nodiscard]] IndiParams indi_params(const PilotConfig& config);
[[nodiscard]] PhaseParams phase_params(const PilotConfig& config);
/// The filter that flies: the configured one, or the one that takes what the pose gives.
[[nodiscard]] FilterModel filter_model(const PilotConfig& config);
/// Nominal rate of the IMU without stamps that its filter estimates by; 0: there is none [Hz].
[[nodiscard]] double slow_imu_hz(const PilotConfig& config);
[[nodiscard]] MapUncertainty map_uncertainty(const PilotConfig& config);

/// @throws std::invalid_argument when pictures arrive later than the filter remembers.
void check_latency(const PilotConfig& config);

}  // namespace gatefly
