// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/ardu_introduction.hpp"

#include "gatefly/live/autopilot_questions.hpp"

namespace gatefly::live {

ArduIntroduction ardu_introduction_of(Port& port, int system) {
  const auto value_of = [](const mavlink::ParamValue& value) { return value.param_value; };
  return AutopilotQuestions<ArduIntroduction>{port, system, guard::kArduParameters, value_of}
      .answers();
}

}  // namespace gatefly::live
