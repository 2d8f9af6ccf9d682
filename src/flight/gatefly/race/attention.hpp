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
/// Every picture is searched quickly. Carefully: where the gate flown to should show and is not found;
/// else, every few pictures, where another gate of the map should. In case the estimate is wrong one part
/// of the picture after the other is searched, too: in each where the drone is lost. Pictures that come more than 0.15 s apart are searched whole. [ours; Li18 has
/// one search]
class Attention {
 public:
  explicit Attention(const SightParams& params) : params_{params} {}

  struct SinceTaken {  ///< How long ago a sighting corrected the filter [s]:
    double any;        ///< of any gate,
    double target;     ///< of the one flown to.
  };
  /// The request for one picture; it refers to this until the next one.
  /// @param ago  as for expected_gate().
  [[nodiscard]] LookFor next(const eskf::ErrorStateFilter& filter, const SinceTaken& since,
                             double ago, const PictureClock& picture);

 private:
  [[nodiscard]] std::optional<SearchWindow> window(const eskf::ErrorStateFilter& filter,
                                                   const std::optional<ExpectedGate>& target,
                                                   bool just_seen, double ago,
                                                   const PictureClock& picture);
  [[nodiscard]] LookFor of_slow_camera(bool target_is_missing, double since_any);
  [[nodiscard]] std::optional<SearchWindow> another_gate(const eskf::ErrorStateFilter& filter,
                                                         double ago, const PictureClock& picture);
  [[nodiscard]] SearchWindow next_part(const eskf::ErrorStateFilter& filter, double ago,
                                       const PictureClock& picture);

  SightParams params_;
  int looks_ = 0;         ///< Pictures since one was searched for something else than the target.
  bool parts_ = false;    ///< Whether that was a part of all.
  int slot_ = 0;          ///< Of the gate looked for last.
  int part_ = 0;          ///< Searched next.
  double arrival_ = 1e9;  ///< Of the picture before [s].
  std::optional<Quad> bars_;
  std::optional<SearchWindow> within_;
};

}  // namespace gatefly
