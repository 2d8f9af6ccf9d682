// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/race/expected_gate.hpp"
#include "gatefly/race/race_params.hpp"

namespace gatefly {

/// Which part of the next picture is worth a careful search, which costs thirty times a quick one if it
/// is of all the picture.
///
/// Every picture is searched quickly. The careful search looks where the gate flown to should show and
/// is not found, and every few pictures where another gate of the map should. In case the estimate is
/// wrong it looks at one part of the picture after the other as well: now and then while the target is
/// missing or out of view, more often once the drone flies blind, always while it is lost. A part that
/// shows a gate which has to be seen twice is searched again at once. A camera that is slower than 13 Hz
/// leaves time to search all of every picture. [ours; Li18 has one search]
class Attention {
 public:
  explicit Attention(const SightParams& params) : params_{params} {}

  struct Known {
    double since_any;     ///< A sighting of any gate corrected the filter so long ago [s].
    double since_target;  ///< The same of the gate flown to [s].
    bool waits = false;   ///< The last picture showed a gate that has to be seen again.
  };
  /// The request for one picture; it refers to this until the next one.
  /// @param ago  as for expected_gate().
  [[nodiscard]] LookFor next(const eskf::ErrorStateFilter& filter, const Known& known, double ago,
                             const PictureClock& picture);

 private:
  [[nodiscard]] std::optional<SearchWindow> window(const eskf::ErrorStateFilter& filter,
                                                   const std::optional<ExpectedGate>& target,
                                                   const Known& known, double ago,
                                                   const PictureClock& picture);
  [[nodiscard]] LookFor at_all(bool target_is_missing, double since_any);
  [[nodiscard]] int another_slot(const eskf::ErrorStateFilter& filter, double ago,
                                 const PictureClock& picture) const;
  [[nodiscard]] SearchWindow part(const eskf::ErrorStateFilter& filter, double ago,
                                  const PictureClock& picture) const;

  SightParams params_;
  int looks_ = 0;       ///< Pictures since one was searched for something else than the target.
  bool parts_ = false;  ///< That picture was searched in a part, not for another gate.
  int slot_ = 0;        ///< The gate that had its turn last, ...
  int part_ = 0;        ///< ... and the part.
  std::optional<Quad> bars_;
  std::optional<SearchWindow> within_;
};

}  // namespace gatefly
