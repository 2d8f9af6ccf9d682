// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/estimation/eskf/error_state_filter.hpp"

namespace gatefly::eskf {

/// A number that was found in flight, and how sure that is.
struct Found {
  double value = 0.0, sigma = 0.0;
};

/// A gate that does not stand where the map has it, seen as it is flown through.
struct GateOff {
  std::size_t gate = 0;                              ///< First of the map's gates there, from 0.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Along its way, to the right, down [m].
  double turned = 0.0;                               ///< Clockwise from above [rad].
  double sigma = 0.0;         ///< Standard deviation of the horizontal offset [m].
  double turned_sigma = 0.0;  ///< [rad]
};

/// Estimated differences from the configuration: camera, thrust, heading, wind and gates.
struct Findings {
  Found tilt, pan, roll;                ///< Camera mount: down, to the right, clockwise [rad].
  Found delay;                          ///< Configured latency minus the true one [s].
  Found focal;                          ///< Relative.
  Found thrust;                         ///< Relative: rotors give so much more than commanded.
  Found heading;                        ///< The drone's, clockwise: corrections altogether [rad].
  Found wind_north, wind_east;          ///< Mean wind, air over ground [m/s].
  FixedList<GateOff, kMaxGates> gates;  ///< All that are states.
  FixedList<GateOff, kMaxGates> off;    ///< Only those beyond what a map may err by.
};

/// @param filter  has started.
[[nodiscard]] Findings findings_of(const ErrorStateFilter& filter);

}  // namespace gatefly::eskf
