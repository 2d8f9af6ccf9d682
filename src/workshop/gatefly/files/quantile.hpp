// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace gatefly::files {

/// The value below which a part of sorted values lies, interpolated; NaN without values.
[[nodiscard]] double quantile(std::span<const double> sorted, double part);

/// The one of `values` whose rank is nearest to that part of them; NaN without values.
[[nodiscard]] double nearest_rank(std::vector<double> values, double part);

}  // namespace gatefly::files
