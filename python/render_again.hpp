// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/tasks/recorded_flight.hpp"

namespace gatefly::python {

/// Renders pictures again that a flight did not keep; empty where there is no simulator.
[[nodiscard]] tasks::RenderAgain render_again();

}  // namespace gatefly::python
