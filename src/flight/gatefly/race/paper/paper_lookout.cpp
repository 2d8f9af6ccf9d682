// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/paper/paper_lookout.hpp"

#include <cmath>

#include "gatefly/race/seen_fix.hpp"

namespace gatefly {
namespace {

constexpr double kAnything = 1e9;
// [m] [Li18 flight code]
constexpr double kBeforeLeg = 1.5;  // farther back than where a leg begins is no fix of it
constexpr double kAtGate =
    0.3;  // so near the gate's plane corners are no longer believed [January]

// By fitness; of equals the one nearest to the middle, as a detector's list has it.
void sort_best_first(GateDetections& gates, int image_width) {
  const double middle = 0.5 * image_width;
  const auto off = [&](const GateDetection& gate) {
    return std::abs(center(gate.corners_px).x() - middle);
  };
  insertion_sort(gates, [&](const GateDetection& a, const GateDetection& b) {
    return a.fitness != b.fitness ? a.fitness > b.fitness : off(a) < off(b);
  });
}

}  // namespace

PaperLookout::PaperLookout(const LookoutParams& params)
    : params_{params}, detector_{params.detector, params.detector_mode} {
  params_.pose.max_misfit = params_.pose.max_bars_lateral = kAnything;  // tests of ours
}

void PaperLookout::look(const Sensors& sensors, bool looking, const Course& course,
                        Navigator& navigator) {
  sighting_.seen = false;
  if (!sensors.image && !sensors.seen) return;
  sighting_ = {};
  if (!sensors.seen && sensors.image->empty()) return;
  if (!looking) return previous_.reset();
  find_gates(sensors);
  const Navigator::Past* then = navigator.at(navigator.time() - params_.timing.latency);
  if (!then) return;
  const bool at_gate = navigator.filter().position().x() > -kAtGate;
  const auto fix = fix_of(*then, course.gate(), !at_gate);
  if (!fix || fix->p_GB.x() > 0.0) return;
  const auto leg = course.approach_length();
  if (leg && fix->p_GB.x() < -*leg - kBeforeLeg) return;
  const bool by_bars = sighting_.bars.has_value();
  const auto source = by_bars ? Sighting::Source::kBars : Sighting::Source::kCorners;
  if (fuse({*fix, then, source}, course.gate(), params_.gate_yaw_sigma, navigator, sighting_) &&
      !by_bars)
    sighting_.used = 0;
}

void PaperLookout::find_gates(const Sensors& sensors) {
  if (sensors.seen) {
    sighting_.detections = sensors.seen->gates;
    sort_best_first(sighting_.detections, sensors.seen->image_width);
    sighting_.bars = sensors.seen->bars;
  } else {
    const GatesInView view = detector_.look(*sensors.image, params_.gate_color,
                                            {.gates = LookFor::Gates::kBest,
                                             .part = LookFor::Part::kToo,
                                             .previous = previous_ ? &*previous_ : nullptr});
    previous_.reset();
    if (!view.gates.empty()) {
      previous_ = view.gates[0].corners_px;
      (void)sighting_.detections.push_back(view.gates[0]);
    }
    if (view.part) sighting_.bars = view.part->bars;
  }
  sighting_.seen = !sighting_.detections.empty();
}

// Bars first, as flown; those that are too far apart or too near each other are none.
std::optional<Fix> PaperLookout::fix_of(const Navigator::Past& then, const MapGate& gate,
                                        bool by_corners) {
  if (sighting_.bars) {
    const auto fix = fix_from_bars(*sighting_.bars, R_GB_of(then), gate.side - gate.bar,
                                   params_.camera, params_.pose);
    if (fix) return fix;
    sighting_.bars.reset();
  }
  if (!sighting_.seen || !by_corners) return std::nullopt;
  return fix_from_corners(sighting_.detections[0].corners_px, R_GB_of(then), gate.side,
                          params_.camera, params_.pose);
}

}  // namespace gatefly
