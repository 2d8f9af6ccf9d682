// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "gatefly/race/messages.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/sensor_faults.hpp"
#include "gatefly/sim/sensors.hpp"
#include "gatefly/simulated_race/closed_loop/autopilot_imu.hpp"
#include "gatefly/simulated_race/closed_loop/stopwatch.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// How often the body is stepped in an interval of the IMU: a thousand times a second at least.
[[nodiscard]] inline int physics_steps(double imu_hz) {
  constexpr double kPhysicsHz = 1024.0;
  return static_cast<int>(std::ceil(kPhysicsHz / imu_hz));
}

/// The camera's schedule: frames are exposed at its rate, some are lost, the others arrive later.
class CameraFeed {
 public:
  CameraFeed(const world::SimConfig& config)
      : truth_{config.sensors},
        faults_{config.faults},
        span_{config.camera.readout + config.camera.exposure},
        schedule_{config.seed, "camera schedule"} {
    history_.reserve(2048);
  }

  void remember(const sim::BodyState& state, double t) {
    if (history_.size() > 1024) history_.erase(history_.begin(), history_.begin() + 512);
    history_.push_back({t, state.p_EB, state.q_EB});
  }

  /// Exposes when a frame's time has ended; true when a frame arrives at `t`.
  template <class Simulator>
  bool advance(double t, Simulator& simulator, Stopwatch& watch) {
    if (t >= next_start_ + span_ && !pending_) {
      const double jitter = std::abs(schedule_.normal_cut(truth_.latency_jitter));
      const bool lost =
          schedule_.uniform() < truth_.frame_loss || world::within(faults_.camera_out, next_start_);
      const bool stuck = exposed_ && world::within(faults_.camera_stuck, next_start_);
      ++frame_;
      if (!lost) {
        if (!stuck) watch.time([&] { simulator.expose(frame_, next_start_, history_); });
        exposed_ = true;
        start_ = next_start_;
        arrival_ = next_start_ + span_ + truth_.camera_latency + jitter;
        pending_ = true;
      }
      next_start_ += 1.0 / truth_.camera_hz;
    }
    if (!pending_ || t < arrival_) return false;
    pending_ = false;
    return true;
  }

  /// When the delivered frame began its exposure [s].
  [[nodiscard]] double start() const { return start_; }
  /// Pose in the middle of it.
  [[nodiscard]] sim::BodyPose middle_pose() const {
    const auto later = std::lower_bound(history_.begin(), history_.end(), start_ + 0.5 * span_,
                                        [](const sim::BodyPose& p, double t) { return p.t < t; });
    return later == history_.end() ? history_.back() : *later;
  }

 private:
  world::SensorTruth truth_;
  world::Faults faults_;
  double span_;
  sim::Stream schedule_;
  std::vector<sim::BodyPose> history_;
  double next_start_ = 0.2, arrival_ = 0.0, start_ = 0.0;
  std::uint32_t frame_ = 0;
  bool pending_ = false, exposed_ = false;
};

/// Everything that looks at the world for the pilot, each at its own rate.
class SensorSuite {
 public:
  explicit SensorSuite(const world::SimConfig& config)
      : faults_{config.faults},
        imu_{config.sensors, config.seed},
        sonar_{config.sensors, config.seed},
        baro_{config.sensors, config.seed},
        camera_{config},
        imu_hz_{config.sensors.imu_hz},
        by_way_{config.autopilot.takes != world::AutopilotTruth::Takes::kNone &&
                config.sensors.autopilot_imu_hz > 0.0},
        sonar_every_{every(config.sensors.sonar_hz)},
        baro_every_{every(config.sensors.baro_hz)} {
    if (config.sensors.autopilot_imu_hz > 0.0) autopilot_.emplace(config.sensors, config.seed);
  }

  /// Until the next IMU sample [s].
  [[nodiscard]] double next_interval() { return imu_.next_interval(); }
  /// Every step of the body, for pictures, which take their time.
  void remember(const sim::BodyState& state, double t) { camera_.remember(state, t); }

  /// Sensor data that arrives at the end of a tick of `dt` [s].
  template <class Simulator>
  Sensors read(std::int64_t tick, double dt, Simulator& simulator, Stopwatch& camera_watch) {
    const sim::BodyState& state = simulator.body.state();
    const double now = simulator.body.time();
    Sensors sensors;
    sensors.time = faults_.stamp(now);
    sensors.imu = own_imu_ = faults_.broken(imu_.measure(state, dt), now);
    if (autopilot_) sensors.navigation_imu = autopilot_->pass_on(sensors.imu, now);
    // A pilot that flies by way of an autopilot has only the IMU that is handed on.
    if (sensors.navigation_imu) handed_on_ = *sensors.navigation_imu;
    if (by_way_) sensors.imu = handed_on_;
    if (tick % sonar_every_ == 0)
      sensors.sonar = faults_.broken(sonar_.measure(state, &simulator.sight()), now);
    if (tick % baro_every_ == 0)
      sensors.baro = baro_.measure(state, static_cast<double>(baro_every_) / imu_hz_);
    if (camera_.advance(now, simulator, camera_watch)) simulator.deliver(sensors);
    return sensors;
  }

  /// The vehicle's own sample of the last read(), which an autopilot goes by.
  [[nodiscard]] const Imu& own_imu() const { return own_imu_; }
  [[nodiscard]] const CameraFeed& camera() const { return camera_; }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  [[nodiscard]] std::int64_t every(double hz) const {
    return std::max<std::int64_t>(1, std::llround(imu_hz_ / hz));
  }

  sim::SensorFaults faults_;
  sim::ImuModel imu_;
  std::optional<AutopilotImu> autopilot_;
  sim::SonarModel sonar_;
  sim::BaroModel baro_;
  CameraFeed camera_;
  double imu_hz_;
  bool by_way_;
  Imu own_imu_;
  Imu handed_on_{.gyro_B = Eigen::Vector3d::Constant(kNone),
                 .accel_B = Eigen::Vector3d::Constant(kNone)};
  std::int64_t sonar_every_, baro_every_;  ///< IMU ticks.
};

}  // namespace gatefly::simulated_race
