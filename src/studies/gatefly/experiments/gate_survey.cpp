// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/gate_survey.hpp"

#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr Eigen::Index kAirframe = 3, kGate = 4, kFlight = 2;  // unknowns
constexpr double kSoftPx = 2.0, kUnseenPx = 100.0;

Eigen::VectorXd unknowns_of(const Survey& s) {
  const auto gates = static_cast<Eigen::Index>(s.gates.size()),
             flights = static_cast<Eigen::Index>(s.flights.size());
  Eigen::VectorXd x(kAirframe + kGate * gates + kFlight * flights);
  x.head<kAirframe>() << s.airframe.camera_roll, s.airframe.exposure_delay, s.airframe.mocap_delay;
  for (Eigen::Index i = 0; i < gates; ++i) {
    const SurveyedGate& gate = s.gates[static_cast<std::size_t>(i)];
    x.segment<kGate>(kAirframe + kGate * i) << gate.p_EG, gate.yaw;
  }
  for (Eigen::Index i = 0; i < flights; ++i) {
    const FlightSetup& flight = s.flights[static_cast<std::size_t>(i)];
    x.segment<kFlight>(kAirframe + kGate * gates + kFlight * i) << flight.heading, flight.tilt;
  }
  return x;
}

Survey survey_of(const Eigen::VectorXd& x, Survey s) {
  const auto gates = static_cast<Eigen::Index>(s.gates.size());
  s.airframe = {.camera_roll = x(0), .exposure_delay = x(1), .mocap_delay = x(2)};
  for (std::size_t i = 0; i < s.gates.size(); ++i) {
    const auto g = x.segment<kGate>(kAirframe + kGate * static_cast<Eigen::Index>(i));
    s.gates[i] = {.p_EG = g.head<3>(), .yaw = g(3)};
  }
  for (std::size_t i = 0; i < s.flights.size(); ++i) {
    const auto f =
        x.segment<kFlight>(kAirframe + kGate * gates + kFlight * static_cast<Eigen::Index>(i));
    s.flights[i] = {.heading = f(0), .tilt = f(1)};
  }
  return s;
}

using Errors = Eigen::Matrix<double, 8, 1>;

Errors errors_px(const Survey& s, std::size_t flight, const SurveyFlight& seen,
                 const GatePicture& picture, const PilotConfig& pilot) {
  const CameraRig rig = mounted(pilot.camera, s.airframe, s.flights[flight]);
  const SurveyedGate& gate = s.gates[seen.gate];
  const auto corners_G = gate_corners_G(pilot.track.gates.front().side);
  const double t = exposed_at(picture, s.airframe, pilot);
  Attitude attitude = seen.motion->attitude(t);
  attitude.yaw += s.flights[flight].heading;
  const Eigen::Matrix3d R_EB = rotation_EB(attitude).matrix;
  const Eigen::Vector3d p_EB = seen.motion->position(t + s.airframe.mocap_delay);
  Errors errors;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p_E = gate.p_EG + rotation_z(gate.yaw) * corners_G[i];
    const auto px = rig.lens.project(rig.R_BC.matrix.transpose() *
                                     (R_EB.transpose() * (p_E - p_EB) - rig.p_BC));
    errors.segment<2>(2 * static_cast<Eigen::Index>(i)) =
        px ? Eigen::Vector2d{*px - picture.px[i]} : Eigen::Vector2d::Constant(kUnseenPx);
  }
  return errors;
}

/// For Eigen's Levenberg-Marquardt: the unknowns in `open`, the others as they are in `x`.
struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  std::span<const SurveyFlight> flights;
  const Survey& form;
  const PilotConfig& pilot;
  Eigen::VectorXd x;
  Eigen::Index first_open;
  int count;

  [[nodiscard]] int inputs() const { return static_cast<int>(x.size() - first_open); }
  [[nodiscard]] int values() const { return count; }
  int operator()(const Eigen::VectorXd& open, Eigen::VectorXd& r) const {
    Eigen::VectorXd all = x;
    all.tail(open.size()) = open;
    const Survey survey = survey_of(all, form);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < flights.size(); ++i)
      for (const GatePicture& picture : flights[i].pictures) {
        r.segment<8>(row) =
            errors_px(survey, i, flights[i], picture, pilot).unaryExpr([](double e) {
              const double soft =
                  2.0 * kSoftPx * kSoftPx * (std::sqrt(1.0 + e * e / (kSoftPx * kSoftPx)) - 1.0);
              return std::copysign(std::sqrt(soft), e);
            });
        row += 8;
      }
    return 0;
  }
};

}  // namespace

double exposed_at(const GatePicture& picture, const Airframe& airframe, const PilotConfig& pilot) {
  // Upright columns are read out one after the other.
  constexpr double kWidth = 315.0;
  return picture.t - airframe.exposure_delay +
         (center(picture.px).x() / kWidth - 0.5) * pilot.camera_timing.readout;
}

CameraRig mounted(CameraRig lens, const Airframe& airframe, const FlightSetup& flight) {
  lens.R_BC = camera_mount(flight.tilt, airframe.camera_roll);
  return lens;
}

double misfit_px(const Survey& survey, std::size_t flight, const SurveyFlight& seen,
                 const GatePicture& picture, const PilotConfig& pilot) {
  return std::sqrt(errors_px(survey, flight, seen, picture, pilot).squaredNorm() / 4.0);
}

Survey surveyed(std::span<const SurveyFlight> flights, const Survey& start, Open open,
                const PilotConfig& pilot) {
  const auto gates = static_cast<Eigen::Index>(start.gates.size());
  const Eigen::Index first = open == Open::kAll           ? 0
                             : open == Open::kNotAirframe ? kAirframe
                                                          : kAirframe + kGate * gates;
  std::size_t pictures = 0;
  for (const SurveyFlight& flight : flights) pictures += flight.pictures.size();
  const Residuals residuals{.flights = flights,
                            .form = start,
                            .pilot = pilot,
                            .x = unknowns_of(start),
                            .first_open = first,
                            .count = static_cast<int>(8 * pictures)};
  Eigen::VectorXd x = residuals.x.tail(residuals.inputs());
  if (residuals.values() < residuals.inputs()) return start;
  Eigen::NumericalDiff<Residuals, Eigen::Central> with_slope{residuals, 1e-10};
  Eigen::LevenbergMarquardt<decltype(with_slope)> descent{with_slope};
  descent.minimize(x);
  Eigen::VectorXd all = residuals.x;
  all.tail(x.size()) = x;
  return survey_of(all, start);
}

}  // namespace gatefly::experiments
