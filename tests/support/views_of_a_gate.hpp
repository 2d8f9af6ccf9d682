// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <ostream>
#include <vector>

#include "gatefly/detection/gate_detection.hpp"

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/worst_corner.hpp"

namespace gatefly::test {

/// From 1.5 to 5 m before the gate, up to 1 m beside its axis, tilted as in flight.
inline View any_view(Rng& rng) {
  return {{rng.uniform(-5, -1.5), rng.uniform(-1, 1), rng.uniform(-0.6, 0.6)},
          {rng.uniform(-0.4, 0.4), rng.uniform(-0.2, 0.1), rng.uniform(-0.3, 0.3)}};
}

/// Every coordinate with normal noise [px].
inline Quad noisy(const Quad& quad, double sigma, Rng& rng) {
  Quad out = quad;
  for (auto& p : out) {
    p.x() += sigma * normal(rng);
    p.y() += sigma * normal(rng);
  }
  return out;
}

/// From where a gate is looked at.
struct Place {
  double distance, roll_deg;
};
inline void PrintTo(const Place& p, std::ostream* out) {
  *out << p.distance << " m, roll " << p.roll_deg << " deg";
}

/// The views of a gate, of twenty, that show it whole, and the worst corner of each that was found
/// [px], sorted.
struct FoundCorners {
  int views = 0;
  std::vector<double> errors;
  [[nodiscard]] int found() const { return static_cast<int>(errors.size()); }
  [[nodiscard]] double median() const { return errors.empty() ? 1e9 : errors[errors.size() / 2]; }
};

/// A clean frame before a noisy wall. @param gates_in  what a detector finds in a canvas.
template <class Detector>
FoundCorners found_corners(const Place& place, const Detector& gates_in) {
  const CameraRig rig = bebop_rig();
  FoundCorners all;
  for_all(20, [&](Rng& rng) {
    const View view{{-place.distance, rng.uniform(-0.4, 0.4), rng.uniform(-0.2, 0.5)},
                    {place.roll_deg * kDegree + rng.uniform(-0.05, 0.05), rng.uniform(-0.1, 0.0),
                     rng.uniform(-0.2, 0.2)}};
    const auto corners = corners_of(1.0, view, rig);
    if (!corners || !inside_picture(*corners, 315, 160, 4)) return;
    ++all.views;
    Canvas canvas(315, 160);
    canvas.draw_gate(view, rig);
    canvas.add_noise(rng);
    const GateDetections found = gates_in(canvas);
    if (!found.empty() && worst_corner(found[0].corners_px, *corners) < 6.0)
      all.errors.push_back(worst_corner(found[0].corners_px, *corners));
  });
  std::sort(all.errors.begin(), all.errors.end());
  return all;
}

}  // namespace gatefly::test
