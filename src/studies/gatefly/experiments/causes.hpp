// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::experiments {

/// Why a race ended: "finished", "crash: obstacle", "abort: ..."; one word for all things of a kind.
[[nodiscard]] inline std::string cause_of(const simulated_race::RaceResult& r) {
  if (r.stop_reason == "abort") return "abort: " + r.abort_reason;
  if (r.stop_reason != "crash") return r.stop_reason;
  // "gate 1 left bar", "obstacle 13", "east wall", "floor"
  const auto first = r.crash_object.substr(0, r.crash_object.find(' '));
  const auto last = r.crash_object.substr(r.crash_object.rfind(' ') + 1);
  const bool is_numbered = last.find_first_not_of("0123456789") == std::string::npos;
  return "crash: " + (is_numbered || first == "gate" ? first : last);
}

/// "3 crash: gate, 1 timeout" of the races that did not finish; "" when all did.
[[nodiscard]] std::string causes_of(const auto& races) {
  std::map<std::string, int> counts;
  for (const simulated_race::RaceResult& r : races)
    if (!r.finished) ++counts[cause_of(r)];
  std::string text;
  for (const auto& [cause, count] : counts)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + cause;
  return text;
}

}  // namespace gatefly::experiments
