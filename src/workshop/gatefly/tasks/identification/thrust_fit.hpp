// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace gatefly::identification {

/// The rotors' command, and the accelerometer's reading.
struct ThrustPoint {
  double t = 0.0;        ///< [s]
  double command = 0.0;  ///< > 0: throttle, rotor speed, thrust; any unit.
  double accel = 0.0;    ///< Specific force upwards along the body, as measured [m/s²].
  double upright = 1.0;  ///< Cosine of the tilt.
  double v_down = 0.0;   ///< [m/s]
};

struct Known {
  double value = 0.0, sigma = 0.0;
};

struct ThrustFit {
  /// The command that carries the drone, in its unit, at this flight's charge of the battery.
  Known hover;
  std::optional<Known> exponent;  ///< Thrust over command; none where it hardly did but hover.
  double accel_bias = 0.0;        ///< To add to what is measured upwards in flight [m/s²].
  double lag = 0.0;               ///< From command to thrust [s].
  double rms = 0.0;               ///< Misfit of a quarter of a second's thrust, relative.
  std::size_t pieces = 0;
};

/// accel + bias = g (command / hover)^exponent, fitted to means over quarters of a second of a
/// flight, each weighing the same. The bias is known by what carried the drone: over all of the
/// flight thrust is gravity, but for what its vertical speed has changed by.
///
/// What changes with the command looks like thrust: a climb's drag, a battery that sags, an
/// accelerometer that vibrates. Neighbouring pieces err alike; the sigmas are wider by as much.
/// @param points  in the air, ascending in time.
/// @return nullopt for less than 3 s of them.
[[nodiscard]] std::optional<ThrustFit> fit_thrust(std::span<const ThrustPoint> points);

}  // namespace gatefly::identification
