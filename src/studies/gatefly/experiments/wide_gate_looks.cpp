// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/wide_gate_looks.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

/// Error of the corners that are reported, from the gate's own; huge where that is behind the camera.
std::vector<double> errors_of(const FoundCorners& found, const sim::GateView& gate) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < 4; ++i)
    if (found.reported[i])
      errors.push_back(gate.drawn[i] ? (found.corners_px[i] - gate.corners_px[i]).norm() : 1e9);
  return errors;
}

/// Distances between the corners that are reported, against the true ones.
double scale_of(const FoundCorners& found, const sim::GateView& gate) {
  double there = 0.0, truth = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (!found.reported[i] || !found.reported[j]) continue;
      there += (found.corners_px[i] - found.corners_px[j]).norm();
      truth += (gate.corners_px[i] - gate.corners_px[j]).norm();
    }
  return truth > 0.0 ? there / truth : 1.0;
}

}  // namespace

int FoundCorners::count() const {
  return static_cast<int>(std::count(reported.begin(), reported.end(), true));
}

bool hits(const FoundCorners& found, const sim::GateView& gate) {
  constexpr double kLeast = 3.0, kOfSide = 0.05;  // [px], of the side
  const double limit = std::max(kLeast, kOfSide * gate.side_px);
  const auto errors = errors_of(found, gate);
  return errors.size() >= 2 &&
         std::all_of(errors.begin(), errors.end(), [&](double e) { return e <= limit; });
}

bool is_about(const FoundCorners& found, const sim::GateView& gate) {
  constexpr double kShared = 0.5, kLeast = 10.0, kOfSide = 0.15;
  const auto errors = errors_of(found, gate);
  const double limit = std::max(kLeast, kOfSide * gate.side_px);
  if (std::count_if(errors.begin(), errors.end(), [&](double e) { return e <= limit; }) >= 2)
    return true;
  const bool drawn = std::all_of(gate.drawn.begin(), gate.drawn.end(), [](bool d) { return d; });
  return drawn && found.count() == 4 && overlaps(found.corners_px, gate.corners_px, kShared);
}

void WideLooks::add(const simulated_race::Picture& picture, const world::World& world,
                    const std::vector<FoundCorners>& found) {
  constexpr double kSame = 0.7;  // [the paper's rule]
  ++pictures;
  for (const sim::GateView& gate : picture.gates) {
    WideLook& look = looks.emplace_back();
    look.seed = picture.seed, look.picture = picture.number, look.gate = gate.gate;
    look.distance = gate.distance, look.side_px = gate.side_px;
    look.sides = gate.distance / world.gates[static_cast<std::size_t>(gate.gate)].side;
    look.outer = sim::seen_corners(gate);
    look.inner = static_cast<int>(std::count(gate.inner_seen.begin(), gate.inner_seen.end(), true));
    const auto hit = std::find_if(found.begin(), found.end(),
                                  [&](const FoundCorners& one) { return hits(one, gate); });
    look.found = hit != found.end();
    look.covered = std::any_of(found.begin(), found.end(), [&](const FoundCorners& one) {
      return look.outer == 4 && one.count() == 4 &&
             overlaps(one.corners_px, gate.corners_px, kSame);
    });
    if (look.found) look.errors_px = errors_of(*hit, gate), look.scale = scale_of(*hit, gate);
    if (look.outer + look.inner == 0) looks.pop_back();
  }
  for (const FoundCorners& one : found)
    if (std::none_of(picture.gates.begin(), picture.gates.end(),
                     [&](const sim::GateView& gate) { return is_about(one, gate); }))
      wrong.push_back({picture.seed, picture.number, one});
}

void WideLooks::add(const WideLooks& more) {
  pictures += more.pictures;
  looks.insert(looks.end(), more.looks.begin(), more.looks.end());
  wrong.insert(wrong.end(), more.wrong.begin(), more.wrong.end());
}

std::string WideLooks::csv() const {
  std::string csv =
      "seed,picture,gate,distance_m,distance_sides,side_px,outer,inner,is,error_px,scale\n";
  const auto text = [](double value) { return files::text_of(value, 4); };
  for (const WideLook& look : looks) {
    double sum = 0.0;
    for (const double e : look.errors_px) sum += e / static_cast<double>(look.errors_px.size());
    csv += std::to_string(look.seed) + "," + std::to_string(look.picture) + "," +
           std::to_string(look.gate + 1) + "," + text(look.distance) + "," + text(look.sides) +
           "," + text(look.side_px) + "," + std::to_string(look.outer) + "," +
           std::to_string(look.inner) + "," + (look.found ? "found" : "missed") + "," +
           (look.found ? text(sum) + "," + text(look.scale) : ",") + "\n";
  }
  for (const Wrong& one : wrong)
    csv += std::to_string(one.seed) + "," + std::to_string(one.picture) + ",,,," +
           text(std::sqrt(std::abs(area(one.found.corners_px)))) + ",,,false,,\n";
  return csv;
}

}  // namespace gatefly::experiments
