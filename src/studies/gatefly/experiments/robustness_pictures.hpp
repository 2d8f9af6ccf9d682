// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/experiments/picture_changes.hpp"

namespace gatefly::experiments {

/// Marks of one kind, one for each row at most.
struct RowMarks {
  std::string name;
  std::vector<double> values;  ///< One a row; NaN: none.
  drawing::Color color;
  bool bars = false;  ///< An upright line instead of a disc.
};

/// Rates by row: names at the left, marks along an axis from 0 to `most`; what is more is drawn
/// there.
[[nodiscard]] drawing::Canvas draw_rows(const std::string& title, std::span<const std::string> rows,
                                        std::span<const RowMarks> marks, double most = 1.0);

/// One picture under every change, its labelled gates and what is found in it as shipped.
[[nodiscard]] drawing::Canvas sheet_of_changes(const UprightPicture& original, const OwnSet& set);

}  // namespace gatefly::experiments
