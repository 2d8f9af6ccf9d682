// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace gatefly {

struct AltimeterParams {
  double sonar_hz = 20.0;     ///< Nominal rate of the sonar. [Bebop]
  double sonar_sigma = 0.04;  ///< [m] [estimate]
  double baro_sigma = 0.30;   ///< Noise of one sample, drift removed [m]. [ours: estimate]
  /// Sonar nearer than expected by more than this saw furniture [m]. [estimate]
  double max_step = 0.20;
  double max_disagreement = 0.35;  ///< Between sonar and slow barometer [m]. [estimate]
  double baro_time = 0.8;          ///< Smoothing of the barometer [s]. [estimate]
  double drift_time = 8.0;         ///< How fast the barometer's drift is followed [s]. [estimate]
  /// Without a good echo for this long, any that agrees with the barometer [s].
  double lost_after = 1.5;
};

/// A height above the floor worth fusing.
struct Height {
  double value = 0.0;  ///< [m]
  double sigma = 0.0;  ///< [m]
};

/// Sonar where it sees the floor, barometer where it does not. The paper's altitude is the
/// autopilot's.
///
/// A sonar flying past a table reads the table. Three checks reject it: the filter's own height,
/// the barometer (slow, drifting, blind to furniture), and that furniture only ever makes the floor
/// *nearer*.
class Altimeter {
 public:
  explicit Altimeter(const AltimeterParams& params) : params_{params} {}

  /// @param height    vertical range of an echo [m]; @param expected the filter's height [m].
  /// @return the height to fuse, or nullopt when the echo is not the floor's.
  std::optional<Height> sonar(double height, double expected, double time) {
    const double step = height - expected;
    const double baro = baro_ - drift_;
    const bool like_baro = !has_baro_ || (height - baro < params_.max_disagreement &&
                                          baro - height < params_.max_disagreement);
    const bool like_filter = step > -params_.max_step && step < 2.0 * params_.max_step;
    if (!has_echo_) last_good_ = time;
    has_echo_ = true;
    if (!like_baro || (!like_filter && time - last_good_ < params_.lost_after)) return std::nullopt;
    if (has_baro_ && like_filter)
      drift_ += (baro_ - height - drift_) * (1.0 / params_.sonar_hz) / params_.drift_time;
    last_good_ = time;
    return Height{height, params_.sonar_sigma};
  }

  /// The drone rose by `meters`, says the filter: the smoothed barometer need not lag behind a
  /// climb.
  void climb(double meters) { baro_ += meters; }

  /// @param height  barometric, above the pad [m].
  std::optional<Height> baro(double height, double time) {
    if (!has_baro_) {
      baro_ = height;
      has_baro_ = true;
    } else {
      const double dt = time - baro_at_;
      if (dt > 0.0)
        baro_ += (height - baro_) * (dt < params_.baro_time ? dt / params_.baro_time : 1.0);
    }
    baro_at_ = time;
    return Height{height - drift_, params_.baro_sigma};
  }

 private:
  AltimeterParams params_;
  bool has_baro_ = false, has_echo_ = false;
  double baro_ = 0.0, baro_at_ = 0.0, drift_ = 0.0, last_good_ = 0.0;
};

}  // namespace gatefly
