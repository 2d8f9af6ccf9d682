// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/tasks/tuning/roc.hpp"
#include "gatefly/tasks/tuning/tune.hpp"

namespace gatefly::experiments {

/// A set of real pictures, ready for our detector: identical pictures once, what is no mistake on
/// the ignored list.
struct OwnSet {
  std::string name;
  LabelledSet files;
  config::Config config;                             ///< Shipped: basement, cyberzoo, washington.
  std::vector<tuning::LabelledImage> first, second;  ///< Halves of the set's rows.
  std::vector<std::string> names;                    ///< Pictures of both.
  tuning::Judging judging;

  [[nodiscard]] std::size_t size() const { return first.size() + second.size(); }
  [[nodiscard]] const tuning::LabelledImage& picture(std::size_t i) const {
    return i < first.size() ? first[i] : second[i - first.size()];
  }
  [[nodiscard]] int gates() const;
};

/// The names of all sets, the small ones first.
[[nodiscard]] const std::vector<std::string>& own_set_names();

/// @throws std::runtime_error one line: data that is missing or wrong.
[[nodiscard]] OwnSet own_set(const std::string& name, const Options& options);

/// How the gate's colours are known.
enum class Colors { kDescribed, kOwnDetections, kLabels };

/// Every picture searched with the colours that the other half taught, on all cores; by the fast
/// search alone if asked.
[[nodiscard]] std::vector<tuning::Judged> judged_by_halves(const OwnSet& set, Colors colors,
                                                           bool fast = false);

}  // namespace gatefly::experiments
