// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/attitude_trial.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/drawn.hpp"
#include "gatefly/sim/sensors.hpp"

namespace gatefly::experiments {
namespace {

// [s]
constexpr double kStep = 1.0 / 512, kRest = 2.0, kSpeedUp = 2.0, kStraight = 1.5, kRollIn = 0.3;
constexpr double kRotorSpeed = 750.0;  // about hover [rad/s]

/// Speed and turning rate of the course at a time.
struct Pace {
  double speed = 0.0, acceleration = 0.0, yaw_rate = 0.0;
};

// Smooth from 0 to 1 with a bounded second derivative.
double ease(double x) { return x <= 0.0 ? 0.0 : x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x); }

struct Course {
  explicit Course(const TurnCourse& course)
      : c{course},
        full{kPi * c.radius / c.speed - kRollIn},
        piece{kStraight + full + 2.0 * kRollIn} {}

  [[nodiscard]] double length() const { return kRest + kSpeedUp + c.turns * piece + kStraight; }
  [[nodiscard]] Pace at(double t) const {
    const double x = (t - kRest) / kSpeedUp;
    Pace pace{.speed = c.speed * ease(x),
              .acceleration = x > 0.0 && x < 1.0 ? c.speed * 6.0 * x * (1.0 - x) / kSpeedUp : 0.0};
    const double flown = t - kRest - kSpeedUp;
    if (flown < 0.0 || flown >= c.turns * piece) return pace;
    const double turning = std::fmod(flown, piece) - kStraight,
                 side = static_cast<int>(flown / piece) % 2 == 0 ? 1.0 : -1.0;
    pace.yaw_rate = side * c.speed / c.radius *
                    (ease(turning / kRollIn) - ease((turning - kRollIn - full) / kRollIn));
    return pace;
  }

  TurnCourse c;
  double full, piece;  ///< Turn at full rate; turn with its straight [s].
};

// The roll and pitch with which thrust, along the body's z alone, and drag make this acceleration.
Attitude attitude_for(const Pace& pace, double yaw, const Eigen::Vector3d& drag) {
  const Eigen::Vector3d v_F{pace.speed, 0, 0},
      force_F{pace.acceleration, pace.speed * pace.yaw_rate, -kGravity};
  Attitude attitude;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Matrix3d R = rotation_EB(attitude).matrix;
    const Eigen::Vector3d down =
        (R * drag.cwiseProduct(R.transpose() * v_F) - force_F).normalized();
    attitude = {-std::asin(down.y()), atan2(down.x(), down.z()), 0.0};
  }
  attitude.yaw = yaw;
  return attitude;
}

}  // namespace

std::vector<Moment> coordinated_turns(const TurnCourse& course, std::uint64_t seed) {
  const world::SimConfig world = sim::drawn({}, world::randomize_level(course.level), seed);
  const Eigen::Vector3d drag{world.vehicle.rotor_drag.x(), world.vehicle.rotor_drag.y(), 0.0};
  sim::ImuModel sensor(world.sensors, seed);
  const Course c(course);
  std::vector<Moment> moments;
  double yaw = 0.0;
  Eigen::Matrix3d before = Eigen::Matrix3d::Identity();
  for (double t = 0.0; t < c.length(); t += kStep) {
    const Pace pace = c.at(t);
    yaw += pace.yaw_rate * kStep;
    Moment moment{.imu = {},
                  .dt = kStep,
                  .z = -1.5,
                  .truth = attitude_for(pace, yaw, drag),
                  .rests = t<kRest, .turns = std::abs(pace.yaw_rate)> 0.1};
    const RotationEB R = rotation_EB(moment.truth);
    const Eigen::AngleAxisd turned(before.transpose() * R.matrix);
    before = R.matrix;
    sim::BodyState state;
    state.rate_B = turned.angle() / kStep * turned.axis();
    state.specific_force_B =
        R.matrix.transpose() *
        (rotation_z(yaw) *
         Eigen::Vector3d{pace.acceleration, pace.speed * pace.yaw_rate, -kGravity});
    if (!moment.rests) state.rotor_speed.fill(kRotorSpeed);
    moment.imu = sensor.measure(state, kStep);
    moments.push_back(moment);
  }
  return moments;
}

}  // namespace gatefly::experiments
