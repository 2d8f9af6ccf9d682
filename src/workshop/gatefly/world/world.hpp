// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace gatefly::world {

/// A gate as it really stands: a square frame on a pole and a foot plate.
struct WorldGate {
  Eigen::Vector3d p_EG{0, 0, -1.5};         ///< Centre of the opening, earth frame [m].
  double yaw_EG = 0.0;                      ///< Direction of flight through it [rad].
  double side = 1.0;                        ///< Outer side of the coloured frame [m].
  double bar = 0.05;                        ///< Width of its bars [m].
  Eigen::Vector3d color{0.95, 0.40, 0.12};  ///< Linear-light albedo, r g b, 0..1.
  bool sought = true;    ///< The pilot looks for this colour; else ideal vision is blind to it.
  bool missing = false;  ///< Not there: neither seen nor touched nor passed.
  double hidden_beyond = 0.0;  ///< Not seen from farther away than this [m]; 0: always seen.
  double depth = 0.05;         ///< Depth of its bars along the way through it [m].
};

/// How gates are painted. [real pictures; docs/simulation.md]
struct GatePaint {
  double width = 0.85;  ///< Part of a bar's width that shows colour.
  double blue = 0.45;   ///< Times the named colour's blue: more orange than its name.
  /// How much of its colour is gone where it is thinnest or dirtiest, 0..1; 0: even.
  double wear = 0.8;

  /// Part of the width of a bar [m] that shows colour: a board is bare for a centimetre at most.
  [[nodiscard]] double part_of(double bar) const {
    constexpr double kBoard = 0.10, kBare = 0.01;
    return bar < kBoard ? width : std::max(width, 1.0 - kBare / bar);
  }
};

/// A solid thing standing on the floor (or hanging, if `bottom` > 0).
struct WorldBox {
  Eigen::Vector2d center{0, 0};  ///< Earth frame, north, east [m].
  Eigen::Vector2d size{1, 1};    ///< Along its own axes [m].
  double heading = 0.0;          ///< [rad]
  double bottom = 0.0;           ///< Height of its lower face above the floor [m].
  double top = 2.0;              ///< Height of its upper face above the floor [m].
  bool pole = false;             ///< Round, of diameter size.x().
};

/// Something of the gate's colour that is no gate.
struct Decoy {
  WorldBox shape;
  Eigen::Vector3d color{0.95, 0.40, 0.12};
};

/// Somebody who walks to and fro on a straight stretch of the floor.
struct Person {
  Eigen::Vector2d from{0, 0}, to{1, 0};     ///< Ends of the stretch, earth frame [m].
  double speed = 0.8;                       ///< [m/s]
  double start = 0.0;                       ///< Way walked at t = 0: there and back again [m].
  double height = 1.75;                     ///< [m]
  Eigen::Vector3d shirt{0.05, 0.06, 0.10};  ///< Linear-light albedos, r g b, 0..1.
  Eigen::Vector3d trousers{0.04, 0.05, 0.08};
};

/// Everything solid that one seed's race happens in: the truth that physics, camera and referee
/// share.
struct World {
  std::string look = "hall";               ///< Textures, lights, clutter. [docs/simulation.md]
  Eigen::Vector3d room_size{14, 16, 3.2};  ///< North, east, height [m].
  Eigen::Vector2d room_center{0, 0};       ///< [m]
  std::vector<WorldGate> gates;            ///< In the order of flight.
  std::vector<WorldGate> false_gates;      ///< Like gates, but not in the map; they do not count.
  GatePaint paint;                         ///< Paint of all of them.
  std::vector<WorldBox> obstacles;
  std::vector<Decoy> decoys;
  std::vector<Person> people;
};

}  // namespace gatefly::world
