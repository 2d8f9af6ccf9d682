// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace gatefly {

/// How the paper's control leaves a gate: straight on, then an arc that ends before the next one.
struct GateExit {
  double run = 0.5;     ///< From the gate's plane to the turn point [m]. [Li18 code: 0.1, 0.5]
  double angle = 0.0;   ///< Angle turned, > 0 to the right [rad].
  double radius = 1.0;  ///< [m] [Li18 code: 0.9-1.9]
};

/// A gate on the team's hand-measured map.
struct MapGate {
  Eigen::Vector3d p_EG{0, 0, -1.5};  ///< Centre of the opening [m].
  double yaw_EG = 0.0;               ///< Direction of flight through it [rad].
  double side = 1.0;                 ///< Outer side of the coloured frame [m].
  double bar = 0.05;                 ///< Width of its bars [m].
  double depth = 0.05;               ///< Thickness of its bars, along the flight direction [m].
  std::optional<GateExit> exit = std::nullopt;  ///< For control.mode = "paper" only.
  // How well that is known, one standard deviation each; nullopt: as PilotConfig says of any gate.
  std::optional<Eigen::Vector3d> position_sigma = std::nullopt;  ///< [m]
  std::optional<double> yaw_sigma = std::nullopt;                ///< [rad]
  std::optional<double> side_sigma = std::nullopt;               ///< [m]
};

/// Something solid whose place the team knows: a box or a pole.
struct MapObstacle {
  Eigen::Vector2d center{0, 0};  ///< [m]
  Eigen::Vector2d size{1, 1};    ///< Along its own axes [m].
  double heading = 0.0;          ///< [rad]
  double height = 2.0;           ///< Above the floor [m].
};

/// The course as the pilot knows it; nominal, never the truth.
struct Track {
  std::string name;
  std::vector<MapGate> gates;  ///< In flight order.
  int laps = 1;
  Eigen::Vector2d start{0, 0};  ///< On the floor [m].
  double start_heading = 0.0;   ///< [rad]
  std::vector<MapObstacle> obstacles;
  Eigen::Vector2d room_center{0, 0}, room_size{1000, 1000};  ///< [m]
  double ceiling = 1000.0;                                   ///< [m]
};

}  // namespace gatefly
