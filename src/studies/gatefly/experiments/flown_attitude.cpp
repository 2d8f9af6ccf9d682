// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/flown_attitude.hpp"

#include <cmath>

#include "gatefly/estimation/navigator.hpp"
#include "gatefly/experiments/attitude_trial.hpp"
#include "gatefly/flight_log/baseline/imu15.hpp"
#include "gatefly/flight_log/baseline/mahony.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/tasks/identification/drag_fit.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kLogRest = 0.7;          // of every flight's log, before the motors start [s]
constexpr double kReferenceSigma = 0.01;  // of a position of motion capture [m]

}  // namespace

FlownAttitude flown_attitude(const std::string& name, const flight_log::FlightFolder& flight,
                             double heading_offset) {
  const auto rows = identification::airborne(flight);
  FlownAttitude result{
      name, {},  {},
      {},   0.0, AttitudeTrace(name + ", beside motion capture", "roll difference [°]")};
  const auto yaw_of = [&](const flight_log::FlightSample& s) {
    return wrap_angle(s.ahrs->yaw + heading_offset);
  };
  Navigator ours{{}};
  baseline::Mahony mahony;
  mahony.start({0.0, 0.0, yaw_of(flight.samples.front())});
  baseline::Imu15 reference{{}};
  double before = 0.0, next = kLogRest;
  Eigen::Vector3d last_p = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rows.last; ++i) {
    const flight_log::FlightSample& s = flight.samples[i];
    const double t = seconds(s.time), dt = i > 0 ? t - before : 0.0;
    before = t;
    if (!s.true_p_EB || !s.ahrs) continue;
    mahony.update(s.imu, dt);
    if (t < kLogRest) {
      if (ours.time() == 0.0) ours.start(*s.true_p_EB, yaw_of(flight.samples.front()));
      ours.rest(s.imu, t);
      reference.start(*s.true_p_EB, {s.ahrs->roll, s.ahrs->pitch, yaw_of(s)},
                      ours.ahrs().accel_bias(), ours.ahrs().gyro_bias());
      continue;
    }
    ours.predict(s.imu, t);
    reference.predict(s.imu, dt);
    if (*s.true_p_EB != last_p)
      reference.correct_position(*s.true_p_EB, Eigen::Vector3d::Constant(kReferenceSigma)),
          last_p = *s.true_p_EB;
    if (t >= next) {
      next = t + kCorrections;
      reference.correct_heading(yaw_of(s), kTrialHeadingSigma);
      ours.correct_height(-s.true_p_EB->z(), kTrialAltitudeSigma);
      ours.correct_heading(wrap_angle(yaw_of(s) - ours.ahrs().attitude().yaw),
                           kTrialHeadingSigma * kTrialHeadingSigma);
    }
    if (i < rows.first) continue;
    const Attitude truth = reference.attitude();
    result.ours.add(ours.ahrs().attitude(), truth), result.mahony.add(mahony.attitude(), truth),
        result.authors.add(*s.ahrs, truth);
    result.trace.add(t, ours.ahrs().attitude().roll - truth.roll,
                     mahony.attitude().roll - truth.roll);
    result.reference_sigma_deg =
        std::sqrt(reference.covariance()(baseline::Imu15::kTheta, baseline::Imu15::kTheta)) /
        kDegree;
  }
  return result;
}

}  // namespace gatefly::experiments
