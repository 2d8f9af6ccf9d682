// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/race/course.hpp"
#include "gatefly/race/messages.hpp"
#include "gatefly/race/race_params.hpp"

namespace gatefly {

struct LookoutParams {
  CameraRig camera;
  CameraTiming timing;
  ColorModel gate_color = ColorModel::described({1.0, 0.4, 0.0});
  GateDetectorParams detector;
  DetectorMode detector_mode = DetectorMode::kOurs;
  PoseParams pose;
  SightParams sight;
  double gate_sigma = 3.5;       ///< Limit beyond which a fix is refused; see DragFilterParams.
  double gate_yaw_sigma = 0.06;  ///< How well gates' headings are known [rad].
};

/// The pilot's eye: picture, navigation and map → a fix of the gate that is flown to.
///
/// Source: Li18 §3.1-3.2. Owns the pending confirmation: after a blind leg, or where a sighting is
/// improbable, two have to agree. Allocates nothing once built.
class Lookout {
 public:
  explicit Lookout(const LookoutParams& params);

  /// One picture, or what somebody else has found in it: corrects the navigator if the target is in
  /// it. Without either nothing happens. `looking` false: the picture is not wanted.
  void look(const Sensors& sensors, bool looking, const Course& course, Navigator& navigator);

  /// Result of the last picture.
  [[nodiscard]] const Sighting& sighting() const { return sighting_; }

 private:
  using Past = Navigator::Past;

  struct Candidate {  ///< A fix that may correct the filter.
    Fix fix;
    const Past* then = nullptr;  ///< When it was exposed.
    double nis = 0.0;            ///< Against the estimate of then.
    Sighting::Source source = Sighting::Source::kNone;
    int detection = -1;       ///< Index of a whole gate; -1: a part of one.
    bool may_restart = true;  ///< No other gate of the map explains it better.
  };

  struct Confirmation {  ///< A gate that was seen and is not believed before a second one agrees.
    double time = 0.0;   ///< [s]
    int passed = 0;      ///< Gates, by then.
    Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< Origin of dead reckoning by its fix [m].
  };

  struct View {  ///< Inputs of one look.
    const Sensors& sensors;
    const Course& course;
    Navigator& navigator;
  };

  struct Expectation {         ///< Expected place of the target gate in the picture.
    bool known = false;        ///< Else the estimate is too old.
    std::optional<Quad> bars;  ///< Middle lines; nullopt: out of view.
  };

  [[nodiscard]] Expectation expectation(const View& view) const;
  [[nodiscard]] bool is_in_picture(const Eigen::Vector2d& px, const View& view) const;
  [[nodiscard]] LookFor look_for(const Expectation& expected, const View& view);
  [[nodiscard]] GateDetections whole_gates(const Sensors& sensors, const LookFor& look_for);
  [[nodiscard]] std::optional<Candidate> best_whole_gate(const View& view) const;
  [[nodiscard]] std::optional<Candidate> best_part(const View& view);
  [[nodiscard]] Candidate candidate(const Fix& fix, const Past& then, Sighting::Source source,
                                    const View& view, int detection = -1) const;
  [[nodiscard]] bool convincing(const std::optional<Candidate>& candidate) const;
  [[nodiscard]] std::optional<Fix> fix_of(const GateDetection& gate, const Past& then,
                                          const View& view) const;
  [[nodiscard]] const Past* past_of(double u_px, const View& view) const;
  [[nodiscard]] PoseParams pose_params(const Navigator& navigator) const;
  [[nodiscard]] double distance_from(const GateDetection& seen, const Past& then,
                                     const MapGate& gate, bool from_behind, const View& view) const;
  [[nodiscard]] double distance_from_others(const GateDetection& seen, const Past& then,
                                            const View& view) const;
  bool is_confirmed(const Candidate& seen, const View& view);
  void correct_with(Candidate seen, const View& view);

  LookoutParams params_;
  GateDetector detector_;
  Sighting sighting_;
  std::optional<Confirmation> pending_;
  int quick_looks_ = 0;         ///< Since the last careful one was allowed.
  double image_width_ = 315.0;  ///< Width of the upright picture [px].
};

}  // namespace gatefly
