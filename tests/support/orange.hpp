// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/color_model.hpp"

namespace gatefly::test {

/// The paper's gates, as somebody describes them.
inline const ColorModel kOrange = ColorModel::described({1.0, 0.4, 0.0});

}  // namespace gatefly::test
