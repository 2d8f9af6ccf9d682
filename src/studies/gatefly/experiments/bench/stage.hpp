// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace gatefly::bench {

/// A piece of work that is measured, and the inputs it is done on.
struct Stage {
  std::string name, what;
  std::size_t inputs = 0;
  std::function<void(std::size_t)> call;  ///< Does the work on input i; the same work each time.
  std::string baseline = {};              ///< The stage it is compared with; "": none.
  /// Calls between two looks at the clock: many for short ones.
  std::size_t at_once = 1;
};

/// Duration of one call [µs].
struct Cost {
  double median = 0.0, p99 = 0.0, most = 0.0;
  /// Least time of each input that was measured: what the work itself takes, whatever else ran.
  std::vector<double> least = {};
};

/// Costs as multiples of a baseline's, input by input.
struct Ratios {
  double median = 0.0, mean = 0.0, p99 = 0.0, most = 0.0;
};

/// How the least times compare on the inputs that both have; all 0 when there are none.
[[nodiscard]] Ratios ratios(const Cost& cost, const Cost& baseline);

/// Costs of all stages, in their order: stage after stage on an input before the next input, so
/// that whatever else the machine does meets all of them. One untimed round comes first.
/// @param stopped  asked often; true ends it early.
[[nodiscard]] std::vector<Cost> measure(std::span<const Stage> stages, int rounds,
                                        const std::function<bool()>& stopped);

/// Least time of several calls [µs]: what the work itself takes.
[[nodiscard]] double least_time(const std::function<void()>& work, int calls);

/// One call: where tools/count_instructions.py begins and ends to count.
void call(const Stage& stage, std::size_t input);

/// The stage of that name; nullptr when there is none.
[[nodiscard]] const Stage* find(std::span<const Stage> stages, const std::string& name);

}  // namespace gatefly::bench
