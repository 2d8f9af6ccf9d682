// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/control/altitude.hpp"
#include "gatefly/control/attitude_command.hpp"
#include "gatefly/control/indi.hpp"
#include "gatefly/control/lateral_pd.hpp"
#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/estimation/ahrs.hpp"
#include "gatefly/estimation/altimeter.hpp"
#include "gatefly/estimation/delayed_filter.hpp"
#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/estimation/velocity_observer.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/phase.hpp"
#include "gatefly/race/track.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly {

/// What somebody else has already found in a picture: the simulator's ideal vision.
struct SeenGates {
  GateDetections gates;                         ///< Best first.
  std::optional<OpenGate> open = std::nullopt;  ///< One cut off above.
  std::optional<GateBars> bars = std::nullopt;  ///< One too near to be whole.
  int image_width = 315;                        ///< Of the upright picture [px].
};

/// What arrives in one tick. Everything but the IMU is slower and mostly absent.
struct Sensors {
  std::chrono::nanoseconds time{0};  ///< Of the IMU sample; must not run backwards.
  Imu imu;
  std::optional<double> sonar = std::nullopt;  ///< Range to what is below, along body z [m].
  std::optional<double> baro = std::nullopt;   ///< Height above the pad [m].
  /// Arrived now, exposed `latency` ago; read in this call only.
  std::optional<Image> image = std::nullopt;
  std::optional<SeenGates> seen = std::nullopt;  ///< Instead of an image, and as late.
};

/// What the drone does next.
struct Command {
  AttitudeCommand attitude;
  /// Rotor speeds [rad/s]: left front, right front, right back, left back.
  std::array<double, 4> motors{};
};

struct SpeedParams {
  /// [rad/(m/s)] of speed error. [ours; paper: constant pitch]
  double pitch_gain = 0.14;
  double max_pitch = 14.0 * kDegree;   ///< Nose down.
  double min_pitch = -12.0 * kDegree;  ///< As nose up: braking.
  /// Roll starts this long before the curve [s]: INDI's lag. [ours]
  double roll_lead = 0.16;
  double brake_lead = 0.7;  ///< Slow down this long before the curve [s]. [ours]
  /// From the last turn to the gate at least [s]. [ours: PD, 2.1 rad/s]
  double settle = 1.3;
  double slowest = 1.0;  ///< ... unless that asks for less than this [m/s]. [ours]
  /// Towards a gate that has not been seen from here [m/s]. [ours]
  double unsure = 1.1;
  double unsure_before = 3.0;  ///< ... once it is nearer than this [m]. [ours]
};

struct CameraTiming {
  double latency = 0.044;  ///< From the middle of the exposure of the middle line to arrival [s].
  double readout = 0.020;  ///< First to last upright column [s].
};

/// Everything a pilot is told before take-off. Start-up only.
struct PilotConfig {
  Track track;
  CameraRig camera;
  CameraTiming camera_timing;
  ColorModel gate_color = ColorModel::described({1.0, 0.4, 0.0});
  GateDetectorParams detector;
  PoseParams pose;
  AhrsParams ahrs;
  DragFilterParams filter;
  VelocityObserverParams velocity;
  AltimeterParams altimeter;
  LateralParams lateral;
  AltitudeParams altitude;
  SpeedParams speed;
  IndiParams indi;
  VehicleParams vehicle;
  PlanParams plan;
  PhaseParams phase;
  double map_sigma = 0.12;  ///< How well gates are known relative to each other [m]. [ours]
  /// Of a gate's centre above the floor [m]. [docs/simulation.md]
  double gate_height_sigma = 0.05;
  double gate_yaw_sigma = 0.06;  ///< And how well their headings are [rad]. [ours]
};

/// What the pilot believes. For logs, displays and tests; nothing flies by it but the pilot.
struct Estimate {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();   ///< [m/s]
  Attitude attitude;
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s]
  /// The position in the frame of the target gate [m] ...
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_GB = Eigen::Matrix3d::Identity();  ///< ... and how sure it is [m²].
  int gates_passed = 0;
};

/// What corrected the filter, as another filter would want it.
struct FixOnCourse {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();            ///< Of now, not of the exposure [m].
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< [m²]; earth axes.
  bool has_height = true;
  std::optional<double> yaw = std::nullopt;  ///< Heading the gate tells [rad] ...
  double yaw_sigma = 0.0;                    ///< ... and how well.
};

/// What became of the last picture.
struct Sighting {
  enum class Source { kNone, kCorners, kBars };  ///< kCorners: four, or the two lower ones.
  bool seen = false;                             ///< At least one gate was detected.
  /// One of them, or a part, gave a fix of the target; the filter may have refused it.
  bool offered = false;
  GateDetections detections;      ///< Best first; the one that was used is `used`.
  int used = -1;                  ///< Index into detections; -1 when none (or bars).
  Source source = Source::kNone;  ///< What corrected the filter, if anything did.
  std::optional<FixOnCourse> fix;
  /// How much it surprised: squared innovation in units of its covariance ...
  double innovation2 = 0.0;
  int innovation_dof = 0;  ///< ... and its degrees of freedom; 0: nothing corrected.
  std::optional<GateBars> bars;
  std::optional<OpenGate> open;  ///< Looked for when no whole gate was of use.
};

/// The drone's mind: sensors in, motor commands out. One object, no threads, no clock.
class Pilot {
 public:
  /// Plans the course. @throws std::invalid_argument when it cannot be flown, saying why.
  explicit Pilot(const PilotConfig& config);

  /// One tick, at the IMU's rate. Never throws, never allocates; non-finite samples are ignored.
  Command step(const Sensors& sensors);

  [[nodiscard]] Estimate estimate() const;
  [[nodiscard]] const Phase& phase() const { return phase_; }
  [[nodiscard]] AbortReason abort_reason() const { return abort_reason_; }
  [[nodiscard]] const Sighting& sighting() const { return sighting_; }
  [[nodiscard]] bool finished() const { return passed_ >= total_gates(); }
  [[nodiscard]] bool landed() const { return std::holds_alternative<Landed>(phase_); }
  [[nodiscard]] int target_gate() const { return target_; }
  [[nodiscard]] const RacePlan& plan() const { return plan_; }

 private:
  using Past = DelayedFilter::Moment;

  struct Candidate {  ///< What might correct the filter.
    Fix fix;
    const Past* then = nullptr;  ///< When it was exposed.
    /// From where the filter believes to have been, squared, in units of the doubt.
    double distance2 = 0.0;
    Sighting::Source source = Sighting::Source::kNone;
    int detection = -1;       ///< Index of a whole gate; -1: a part of one.
    bool may_restart = true;  ///< No other gate of the map explains it better.
  };

  struct Witness {      ///< A gate that was seen after a blind leg, or where it surprises.
    double time = 0.0;  ///< [s]
    /// Where dead reckoning began, says its fix [m].
    Eigen::Vector3d start = Eigen::Vector3d::Zero();
  };

  double advance_clock(std::chrono::nanoseconds time);
  void sense(const Imu& imu, double dt);
  void estimate_motion(double dt);
  void measure_height(const Sensors& sensors);
  void look(const Sensors& sensors);
  enum class Effort { kSure, kAll };  ///< kSure: what stands out is enough.
  [[nodiscard]] GateDetections whole_gates(const Sensors& sensors, Effort effort);
  [[nodiscard]] std::optional<Candidate> best_whole_gate() const;
  [[nodiscard]] std::optional<Candidate> best_part(const Sensors& sensors);
  [[nodiscard]] Candidate candidate(const Fix& fix, const Past& then, Sighting::Source source,
                                    int detection = -1) const;
  [[nodiscard]] bool convincing(const std::optional<Candidate>& candidate) const;
  bool fuse(const Candidate& seen);
  void learn_heading_from_leg(const Candidate& seen);
  void correct_heading(double error, double variance);
  [[nodiscard]] std::optional<Fix> fix_of(const GateDetection& gate, const Past& then) const;
  bool is_second_witness(const Candidate& seen);
  bool correct_with(Candidate seen);
  [[nodiscard]] double surprise(const GateDetection& seen, const Past& then, const MapGate& gate,
                                bool from_behind) const;
  [[nodiscard]] double surprise_of_others(const GateDetection& seen, const Past& then) const;
  void follow_course();
  void pass_gate();
  void approach_from_here();
  AttitudeCommand command(double dt);
  AttitudeCommand command_for(const TakeOff& phase, double dt);
  AttitudeCommand command_for(const Straight& phase, double dt);
  AttitudeCommand command_for(Turn& phase, double dt);
  AttitudeCommand command_for(const Search& phase, double dt);
  AttitudeCommand command_for(const Land& phase, double dt);
  AttitudeCommand hold(const Eigen::Vector2d& p_E, double yaw, double z, double dt);

  [[nodiscard]] int total_gates() const {
    return static_cast<int>(config_.track.gates.size()) * config_.track.laps;
  }
  [[nodiscard]] const MapGate& gate() const {
    return config_.track.gates[static_cast<std::size_t>(target_)];
  }
  [[nodiscard]] const Path& path() const;
  [[nodiscard]] Situation situation() const;
  [[nodiscard]] RotationGB R_GB(const Eigen::Matrix3d& R_EB) const;
  [[nodiscard]] const DragFilter& filter() const { return memory_.now(); }
  [[nodiscard]] Eigen::Vector3d p_EB() const;
  [[nodiscard]] double capture_time(double u_px) const;
  [[nodiscard]] PoseParams pose_params() const;
  [[nodiscard]] double lateral_at_gate() const;
  [[nodiscard]] double forward_speed() const;
  [[nodiscard]] double wanted_speed() const;
  [[nodiscard]] double pitch_for_speed(double speed) const;
  [[nodiscard]] double vertical_accel(double z_target, double vz_target, double dt);
  [[nodiscard]] double thrust_for(double accel_up) const;
  [[nodiscard]] double cross_track_roll(double s) const;

  PilotConfig config_;
  RacePlan plan_;
  Ahrs ahrs_;
  LowPass accel_filter_;
  DelayedFilter memory_;  ///< The drag filter, and what it was when pictures were exposed.
  VelocityObserver velocity_;
  Altimeter altimeter_;
  Altitude altitude_;
  Indi indi_;
  GateDetector detector_;
  Phase phase_ = OnGround{};
  AbortReason abort_reason_ = AbortReason::kNone;
  Sighting sighting_;

  double time_ = 0.0, last_imu_ = 0.0, last_fix_ = -1e3;
  bool started_ = false;
  drag_model::Input input_;
  std::optional<Witness> witness_;
  double image_width_ = 315.0;
  int target_ = 0, passed_ = 0;
  std::optional<Path> approach_;  // instead of the leg's own way, after a search
  double progress_ = 0.0;         ///< Metres along path().
  Eigen::Vector2d hold_integral_ = Eigen::Vector2d::Zero();  ///< [m/s²]
  double hold_x_ = -2.0;  ///< Where to wait before the gate while searching [m].
};

}  // namespace gatefly
