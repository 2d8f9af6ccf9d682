// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/gates_in_picture.hpp"

namespace gatefly::tasks {

std::vector<GateDetection> gates_in_picture(const Image& image, GateDetector& detector,
                                            const PilotConfig& config, bool all) {
  LookFor look_for{.gates = all ? LookFor::Gates::kAll : LookFor::Gates::kBest,
                   .part = all ? LookFor::Part::kToo : LookFor::Part::kWithoutGate};
  if (!detector.parts_have_corners()) look_for.part = LookFor::Part::kNo;
  const GatesInView view = detector.look(image, config.gate_color, look_for);
  std::vector<GateDetection> gates(view.gates.begin(), view.gates.end());
  if (view.part) gates.push_back(view.part->gate);
  return gates;
}

}  // namespace gatefly::tasks
