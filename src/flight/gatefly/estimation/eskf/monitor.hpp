// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly::eskf {

/// How a filter shows, without any truth, that it is lost.
enum class Divergence {
  kInnovations,  ///< Accepted measurements have been too far off for a second.
  kNothingFits,  ///< Gates are seen for two seconds, and none is taken in.
};

struct MonitorParams {
  double window = 1.0;    ///< Innovations of so long are summed ... [s]
  double beyond = 1.0;    ///< ... and may be beyond their bound for so long [s].
  double bound = 3.0902;  ///< 99.9 % of a normal number, one side.
  double unfit = 2.0;     ///< Gates may be seen for so long and none taken in [s].
  double pause = 0.5;     ///< Not seen for so long: it begins anew [s].
  int least = 10;         ///< So many of them at least.
  double between =
      0.25;  ///< The longest time between two pictures that one shows the whole of [s].
};

/// Watches what becomes of sightings, and says when the filter has diverged.
class Monitor {
 public:
  explicit Monitor(const MonitorParams& params = {}) : params_{params} {}

  /// A picture was looked at, whatever it shows. Gates refused in it were in view since the one before:
  /// ten pictures at 5 Hz are two seconds.
  void looked(double time);
  /// A sighting was taken in, which was so far off before that.
  void taken(double nis, int rows, double time);
  /// A detection that its detector is sure of fitted nowhere.
  void refused(double time);

  struct Verdict {
    Divergence why = Divergence::kInnovations;
    double since = 0.0;  ///< [s]
  };
  /// The first time that it was lost; nullopt while it never was.
  [[nodiscard]] const std::optional<Verdict>& verdict() const { return verdict_; }

 private:
  struct One {
    double time = 0.0, nis = 0.0;
    int rows = 0;
  };
  MonitorParams params_;
  FixedList<One, 64> recent_;
  std::optional<double> beyond_since_, unfit_since_;
  double last_refused_ = -1e3, last_look_ = -1e3, look_before_ = -1e3;
  int refused_ = 0;
  std::optional<Verdict> verdict_;
};

/// One line for who asks.
[[nodiscard]] const char* text_of(Divergence why);

}  // namespace gatefly::eskf
