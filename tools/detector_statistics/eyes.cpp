// SPDX-License-Identifier: Apache-2.0
#include "eyes.hpp"

#include <algorithm>

#include "gatefly/race/seen_fix.hpp"

namespace gatefly::measuring {
namespace {

LookoutParams for_detector(LookoutParams params, Detector detector) {
  params.detector_mode = detector == kPaper ? DetectorMode::kFlown : DetectorMode::kOurs;
  return params;
}

}  // namespace

Eye::Eye(Detector detector, const LookoutParams& params)
    : params_{for_detector(params, detector)},
      detector_{params_.detector, params_.detector_mode},
      is_paper_{detector == kPaper} {}

std::vector<GateDetection> Eye::whole(const Image& image, LookFor::Gates wanted) {
  const GatesInView view = detector_.look(
      image, params_.gate_color, {.gates = wanted, .previous = previous_ ? &*previous_ : nullptr});
  previous_.reset();
  if (is_paper_ && !view.gates.empty()) previous_ = view.gates[0].corners_px;
  std::vector<GateDetection> gates;
  for (const GateDetection& gate : view.gates)
    if (gate.whole) gates.push_back(with_outer_corners(gate, params_));
  return gates;
}

Answer Eye::look(const Image& image, const std::optional<Quad>& target) {
  Answer answer{
      .gates = whole(image, LookFor::Gates::kStandingOut), .lower = {}, .bars = {}, .cut = {}};
  const bool convincing =
      target && std::any_of(answer.gates.begin(), answer.gates.end(), [&](const GateDetection& g) {
        return overlaps(g.corners_px, *target, kSame);
      });
  const bool was_quick = !answer.gates.empty() && answer.gates[0].method == DetectionMethod::kSnake;
  if (!is_paper_ && !convincing && was_quick) answer.gates = whole(image, LookFor::Gates::kAll);
  const GatesInView view = detector_.look(
      image, params_.gate_color, {.gates = LookFor::Gates::kNone, .part = LookFor::Part::kToo});
  if (view.part) {
    answer.bars = view.part->bars;
    if (!is_paper_) answer.lower = view.part->lower_corners(), answer.cut = view.part->gate;
  }
  return answer;
}

}  // namespace gatefly::measuring
