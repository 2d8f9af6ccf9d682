// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/estimation/eskf/monitor.hpp"
#include "gatefly/race/arrival_jitter.hpp"
#include "gatefly/race/association.hpp"
#include "gatefly/race/attention.hpp"
#include "gatefly/race/lookout.hpp"
#include "gatefly/race/stray_gate.hpp"

namespace gatefly {

/// When a sighting is taken for a gate of the map.
struct MapSightParams {
  double max_nis = 25.0;        ///< With 8 rows: refuses 1 in 600 true sightings. [chi-square]
  double max_lower_nis = 16.0;  ///< With 4 rows: 1 in 300.
  double max_three_nis = 20.0;  ///< With 6 rows: 1 in 360.
  double max_bars_nis = 11.0;   ///< With 2 rows: 1 in 250.
  double part_sigma =
      1.0;  ///< A part may be any gate's for who knows less of his place [m]. [estimate]
  double unsure_nis = 14.0;     ///< The limit for detections that are not sure: 1 in 12.
  double confirm_above = 17.0;  ///< A second one of the same gate has to agree: 1 in 33.
  double margin = 3.0;       ///< Next best explanation so much less probable, −2 ln p. [estimate]
  double blind_after = 1.0;  ///< Nothing seen for so long: two have to agree [s].
  double confirm_within =
      0.6;                 ///< A gate half hidden is found in every fourth picture [s]. [estimate]
  int lost_after = 8;      ///< So many sure detections refused in a row, ...
  double lost_time = 0.7;  ///< ... over so long: the position is in doubt [s]. [estimate]
};

/// The pilot's eye for the filter that has the map among its states: every gate it sees corrects, not
/// only the one it flies to.
///
/// Allocates nothing once built.
class MapLookout {
 public:
  explicit MapLookout(const LookoutParams& params);

  /// See Lookout::look.
  void look(const Sensors& sensors, bool looking, const Course& course, Navigator& navigator);
  [[nodiscard]] const Sighting& sighting() const { return sighting_; }
  /// Whether the camera of a drone that stands level at p_GB, facing the gate, shows all of it.
  [[nodiscard]] bool would_show_whole(const MapGate& gate, const Eigen::Vector3d& p_GB) const;
  /// Whether the filter has diverged, judged by what became of sightings.
  [[nodiscard]] const eskf::Monitor& monitor() const { return monitor_; }

 private:
  struct View {
    const Sensors& sensors;
    const Course& course;
    Navigator& navigator;
    PictureClock picture;
  };
  [[nodiscard]] GateDetections whole_gates(const Sensors& sensors, const LookFor& look_for);
  void take_whole_gates(const View& view);
  void take_parts(const View& view);
  void take_cut(const View& view, const eskf::GateSight& sight);
  bool take_part(const View& view, std::optional<eskf::GateSight> sight, double max_nis,
                 Sighting::Source source);
  [[nodiscard]] bool target_should_show(const View& view, double ago) const;
  [[nodiscard]] bool seen_again(const eskf::GateSight& sight);
  [[nodiscard]] bool believed(const Associated& seen, const GateDetection& gate, bool target,
                              bool blind);
  void note_stray(const GateDetection& gate, const View& view);
  void describe_fix(const GateDetection& gate, const View& view);
  [[nodiscard]] bool is_target(const eskf::GateSight& sight, const View& view) const;

  LookoutParams params_;
  MapSightParams map_;
  GateDetector detector_;
  Attention attention_;
  Sighting sighting_;
  eskf::Monitor monitor_;
  ArrivalJitter arrivals_;
  StrayGate stray_;
  struct {
    int face = -1;
    double time = -1e3;
    bool waits = false;            ///< The picture before showed it.
  } pending_;                      ///< Seen once, and not believed before it is seen again.
  Eigen::Vector2d size_px_{0, 0};  ///< Of the last picture.
  double last_any_ = -1e3;         ///< A gate was taken in [s].
  bool target_seen_ = false;       ///< By its corners, in this approach.
  int passed_ = 0;                 ///< Gates, when a picture came last.
  int refused_ = 0;                ///< Sure detections since then.
};

}  // namespace gatefly
