// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/sim/gates_in_view.hpp"
#include "gatefly/simulated_race/labelled_pictures.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::experiments {

/// A detector's answer about one gate: corners, clockwise from the top left one, and which of them it
/// has seen.
struct FoundCorners {
  Quad corners_px{};
  std::array<bool, 4> reported{};
  [[nodiscard]] int count() const;
};

/// One gate in one picture.
struct WideLook {
  std::uint64_t seed = 0;
  std::size_t picture = 0;
  int gate = 0;                     ///< From 0.
  double distance = 0.0;            ///< [m]
  double sides = 0.0;               ///< The same in sides of the gate.
  double side_px = 0.0;             ///< GateView::side_px.
  int outer = 0, inner = 0;         ///< Corners in view.
  bool found = false;               ///< See hits().
  bool covered = false;             ///< By a frame of four corners that shares 70 % of both areas.
  double scale = 1.0;               ///< Found corners' distances / true.
  std::vector<double> errors_px{};  ///< Errors of the found corners.
};

/// Whether every corner that is reported, two at least, is within max(3 px, 5 % of the side) of the
/// gate's own.
[[nodiscard]] bool hits(const FoundCorners& found, const sim::GateView& gate);

/// Whether it is about this gate at all, seen from whatever side, whole, cut or hidden: half of both
/// areas, or two corners within 15 % of the side. What is about none is a false detection.
[[nodiscard]] bool is_about(const FoundCorners& found, const sim::GateView& gate);

/// Looks at many pictures.
struct WideLooks {
  struct Wrong {
    std::uint64_t seed = 0;
    std::size_t picture = 0;
    FoundCorners found;
  };
  std::size_t pictures = 0;
  std::vector<WideLook> looks;
  std::vector<Wrong> wrong;

  void add(const simulated_race::Picture& picture, const world::World& world,
           const std::vector<FoundCorners>& found);
  void add(const WideLooks& more);
  [[nodiscard]] std::string csv() const;
};

}  // namespace gatefly::experiments
