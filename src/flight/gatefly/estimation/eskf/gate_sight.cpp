// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/gate_sight.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/pose/bearing_model.hpp"

namespace gatefly::eskf {
namespace {

// Columns of the Jacobian, in this order.
constexpr int cP = 0, cV = 3, cTheta = 6, cMount = 9, cFocal = 12, cBend = 13, cDelay = 14,
              cCorner = 15, cGate = 18;
static_assert(cGate + kPerGate == GateRows::kColumns);

constexpr int kIterations = 3;  // Gauss-Newton iterations for one sighting

std::array<int, GateRows::kColumns> states_of(int slot) {
  std::array<int, GateRows::kColumns> states{};
  const auto put = [&](int column, int state, int count) {
    for (int i = 0; i < count; ++i) states[static_cast<std::size_t>(column + i)] = state + i;
  };
  put(cP, kP, 3), put(cV, kV, 3), put(cTheta, kTheta, 3), put(cMount, kMount, 3);
  put(cFocal, kFocal, 1), put(cBend, kBend, 1), put(cDelay, kDelay, 1), put(cCorner, kCorner, 3);
  put(cGate, gate_at(slot), kPerGate);
  return states;
}

// A thing of a gate at the moment it was exposed, and the derivatives of its bearing.
template <int Rows>
struct Seen {
  Eigen::Matrix<double, Rows, 1> residual;
  Eigen::Matrix<double, Rows, 3> by_point, by_turn, by_mount;
  Eigen::Matrix<double, Rows, 1> by_focal, by_bend;
};

struct Moment {
  CameraPose camera;
  Eigen::Vector3d rate_E;
  double after;  ///< So long after the belief [s].
};

Moment moment_of(const Nominal& x, double after, const CameraModel& camera) {
  const Eigen::Matrix3d R = x.R_EB * rotation_of(after * x.rate_B);
  return {{.p_EB = x.p_EB + after * x.v_E,
           .R_EB = R,
           .R_BC = x.R_BC,
           .p_BC = camera.p_BC,
           .focal = x.focal,
           .bend = x.bend},
          R * x.rate_B,
          after};
}

template <int Rows>
void put(GateRows& rows, int row, const Seen<Rows>& seen, const Moment& moment, const Nominal& x,
         const Eigen::Vector3d& arm_E) {
  auto H = rows.jacobian.middleRows<Rows>(row);
  H.setZero();
  rows.residual.segment<Rows>(row) = seen.residual;
  H.template middleCols<3>(cP) = -seen.by_point;
  H.template middleCols<3>(cV) = -moment.after * seen.by_point;
  H.template middleCols<3>(cTheta) = seen.by_turn;
  H.template middleCols<3>(cMount) = seen.by_mount;
  H.col(cFocal) = seen.by_focal;
  H.col(cBend) = seen.by_bend;
  H.col(cDelay) = seen.by_turn * moment.rate_E - seen.by_point * x.v_E;
  H.template middleCols<3>(cGate + kGateP) = seen.by_point;
  H.col(cGate + kGateYaw) = seen.by_point * Eigen::Vector3d{-arm_E.y(), arm_E.x(), 0.0};
}

bool put_corner(GateRows& rows, int row, const Feature& feature, const Moment& moment,
                const Nominal& x, const GateBelief& gate, const Eigen::Matrix3d& R_EG,
                const GateShape& shape) {
  const bool is_opening = feature.kind == Feature::Kind::kOpening;
  const double side = is_opening ? shape.side - 2.0 * shape.bar : shape.side;
  const Eigen::Vector3d corner_G = side * gate_corners_G(1.0)[feature.which & 3],
                        nominal_E = R_EG * corner_G;
  Eigen::Vector3d arm_E = (1.0 + gate.size) * nominal_E - shape.near_face * R_EG.col(0);
  if (shape.near_face != 0.0) {
    const CameraPose& camera = moment.camera;
    const Eigen::Vector3d eye_E = camera.p_EB + camera.R_EB * camera.p_BC - gate.p_EG;
    arm_E += R_EG * outline_shift_G(corner_G, R_EG.transpose() * eye_E, shape.near_face,
                                    is_opening ? CornerOf::kOpening : CornerOf::kFrame);
  }
  const auto seen = point_bearing(gate.p_EG + arm_E, feature.bearing_C, moment.camera);
  if (!seen) return false;
  put<2>(rows, row,
         {seen->residual, seen->by_point, seen->by_turn, seen->by_mount, seen->by_focal,
          seen->by_bend},
         moment, x, arm_E);
  rows.jacobian.block<2, 1>(row, cGate + kGateSize) = seen->by_point * nominal_E;
  return true;
}

// Its noise: the detector's, and what the bar leans at its distance.
bool put_bar(GateRows& rows, int row, const Feature& feature, const Moment& moment,
             const Nominal& x, const GateBelief& gate, const Eigen::Matrix3d& R_EG,
             const GateShape& shape) {
  const double half = 0.5 * (shape.side - shape.bar);
  const Eigen::Vector3d nominal_E = R_EG * Eigen::Vector3d{0, feature.which == 0 ? -half : half, 0};
  const Eigen::Vector3d arm_E = (1.0 + gate.size) * nominal_E - shape.near_face * R_EG.col(0);
  const auto seen =
      line_bearing(gate.p_EG + arm_E, Eigen::Vector3d::UnitZ(), feature.bearing_C, moment.camera);
  if (!seen) return false;
  Seen<1> one;
  one.residual(0) = seen->residual;
  one.by_point = seen->by_point, one.by_turn = seen->by_turn, one.by_mount = seen->by_mount;
  one.by_focal(0) = seen->by_focal, one.by_bend(0) = seen->by_bend;
  put<1>(rows, row, one, moment, x, arm_E);
  rows.jacobian(row, cGate + kGateSize) = seen->by_point.dot(nominal_E);
  rows.noise(row, row) = 1.0 / (seen->distance * seen->distance);  // finished by noise_of
  return true;
}

// Shared by all corners: to the right, down, away from their middle.
using Shared = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, GateRows::kMaxRows, 3>;
Shared shared_by(const GateSight& sight) {
  Shared shared = Shared::Zero(2 * static_cast<Eigen::Index>(sight.features.size()), 3);
  for (std::size_t i = 0; i < sight.features.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    shared(row, 0) = shared(row + 1, 1) = 1.0;
    shared.block<2, 1>(row, 2) = sight.features[i].from_middle_px.normalized();
  }
  return shared;
}

double squared(double x) { return x * x; }

void add_noise(GateRows& rows, const Nominal& x, const GateSight& sight, bool fresh,
               const CameraModel& camera, const SightNoise& noise) {
  const double px = camera.radians_per_px;
  const Eigen::Index n = rows.residual.size();
  for (std::size_t i = 0, row = 0; i < sight.features.size(); ++i) {
    const auto r = static_cast<Eigen::Index>(row);
    if (sight.features[i].kind == Feature::Kind::kBar) {
      rows.noise(r, r) = squared(noise.bars * px) + squared(noise.bar_lean) * rows.noise(r, r);
      row += 1;
      continue;
    }
    const double own = sight.quality == GateSight::Quality::kPart ? noise.part : noise.own;
    rows.noise(r, r) = rows.noise(r + 1, r + 1) = squared(own * px);
    row += 2;
  }
  rows.noise +=
      squared(sight.jitter) * rows.jacobian.col(cDelay) * rows.jacobian.col(cDelay).transpose();
  if (sight.quality == GateSight::Quality::kPart) return;
  const Shared shared = shared_by(sight);
  Eigen::Vector3d variance{squared(noise.together * px), squared(noise.together * px),
                           squared(noise.size * px)};
  if (fresh) {
    variance += Eigen::Vector3d{squared(noise.lasting * px), squared(noise.lasting * px),
                                squared(noise.lasting_size * px)};
  } else {
    rows.jacobian.middleCols<3>(cCorner) = shared;
    rows.residual -= shared * x.corner;
  }
  const GateRows::Noise together = shared.lazyProduct(variance.asDiagonal() * shared.transpose());
  rows.noise.topLeftCorner(n, n) += together;
}

using Spread =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, GateRows::kMaxRows>;

// P Hᵀ.
Spread spread(const Covariance& P, const GateRows& rows) {
  Spread PHt = Spread::Zero(P.rows(), rows.residual.size());
  for (int c = 0; c < GateRows::kColumns; ++c)
    for (Eigen::Index r = 0; r < PHt.cols(); ++r)
      if (const double h = rows.jacobian(r, c); h != 0.0)
        PHt.col(r) += h * P.col(rows.states[static_cast<std::size_t>(c)]);
  return PHt;
}

// S = H P Hᵀ + R.
GateRows::Noise innovation_covariance(const Spread& PHt, const GateRows& rows) {
  GateRows::Noise S = rows.noise;
  for (int c = 0; c < GateRows::kColumns; ++c)
    S += rows.jacobian.col(c) * PHt.row(rows.states[static_cast<std::size_t>(c)]);
  return 0.5 * (S + S.transpose());
}

// ln of a positive number: 2 atanh((m - 1) / (m + 1)) of the mantissa; no libm.
double natural_log(double value) {
  constexpr double kLn2 = 0.69314718055994530942;
  int exponent = 0;
  const double m = std::frexp(value, &exponent);  // [0.5, 1)
  const double z = (m - 0.75) / (m + 0.75), z2 = z * z;
  constexpr double kLn075 = -0.28768207245178092744;
  return exponent * kLn2 + kLn075 +
         2.0 * z * (1.0 + z2 * (1.0 / 3 + z2 * (1.0 / 5 + z2 * (1.0 / 7 + z2 / 9))));
}

// How much greater than told the noise is that innovations y show, after one more picture: where the
// likelihood of y is greatest in R's scale, yᵀ S⁻¹ R S⁻¹ y = tr(R S⁻¹).
double learnt_spread(double spread, const GateRows::Residual& y, const GateRows& rows,
                     const Eigen::LLT<GateRows::Noise>& S, const SightNoise& noise) {
  constexpr double kMost = 4.0;  // One picture that is no gate says no more than this.
  const GateRows::Residual z = S.solve(y);
  const double seen = z.dot(rows.noise * z), told = S.solve(rows.noise).trace();
  if (!(told > 0.0)) return spread;
  const double next = spread * (1.0 + noise.spread_gain * (std::min(seen / told, kMost) - 1.0));
  return std::clamp(next, noise.least_spread, noise.most_spread);
}

// One Gauss-Newton step from rows that are linearised at `error` from the prior: their residual as it
// would be at the prior, S in factors, and P Hᵀ.
struct Step {
  Step(const Covariance& P, const GateRows& rows, const ErrorVector& error)
      : PHt{spread(P, rows)}, S{innovation_covariance(PHt, rows)}, y{rows.residual} {
    for (int c = 0; c < GateRows::kColumns; ++c)
      y += rows.jacobian.col(c) * error(rows.states[static_cast<std::size_t>(c)]);
  }
  [[nodiscard]] bool possible() const { return S.info() == Eigen::Success; }
  /// The error's mean that explains the rows best.
  [[nodiscard]] ErrorVector error() const { return PHt * S.solve(y); }
  Spread PHt;
  Eigen::LLT<GateRows::Noise> S;
  GateRows::Residual y;
};

// How far the rows are from what is expected; the step's error takes the place of the one that they
// were linearised at.
[[gnu::noinline]] std::optional<Innovation> innovation(const Covariance& P, const GateRows& rows,
                                                       ErrorVector& error) {
  const Step step{P, rows, error};
  if (!step.possible()) return std::nullopt;
  Innovation out;
  out.rows = static_cast<int>(step.y.size());
  out.nis = step.S.matrixL().solve(step.y).squaredNorm();
  for (Eigen::Index i = 0; i < step.S.rows(); ++i)
    out.log_det += 2.0 * natural_log(step.S.matrixLLT()(i, i));
  error = step.error();
  return out;
}

using SpreadTransposed =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, GateRows::kMaxRows, kMaxStates>;

// One Gauss-Newton step: the error's mean, and Wᵀ with W Wᵀ = P Hᵀ S⁻¹ H P; and, from the spread there is, the next.
// Never inlined, as what follows: its matrices shall not be on the stack while rows are made.
[[gnu::noinline]] bool iterate(const Covariance& P, const GateRows& rows, const SightNoise& noise,
                               const double* learns_from, double* learnt, ErrorVector& error,
                               SpreadTransposed& Wt) {
  const Step step{P, rows, error};
  if (!step.possible()) return false;
  error = step.error();
  if (learns_from != nullptr) *learnt = learnt_spread(*learns_from, step.y, rows, step.S, noise);
  Wt = step.PHt.transpose();
  step.S.matrixL().solveInPlace(Wt);
  return true;
}

// P - W Wᵀ, column after column.
[[gnu::noinline]] void narrow(Covariance& P, const SpreadTransposed& Wt) {
  const Spread W = Wt.transpose();
  for (Eigen::Index r = 0; r < W.cols(); ++r)
    for (Eigen::Index j = 0; j < P.cols(); ++j) P.col(j) -= W(j, r) * W.col(r);
}

// Nothing is known of what lasts of another gate's corners.
void forget_corner(Nominal& x, Covariance& P, int face, const CameraModel& camera,
                   const SightNoise& noise) {
  x.corner.setZero(), x.corner_of = face;
  P.middleRows<3>(kCorner).setZero();
  P.middleCols<3>(kCorner).setZero();
  for (int i = 0; i < 3; ++i)
    P(kCorner + i, kCorner + i) =
        squared(camera.radians_per_px * (i < 2 ? noise.lasting : noise.lasting_size));
}

}  // namespace

std::optional<GateRows> gate_rows(const Nominal& x, const GateSight& sight, const GateShape& gate,
                                  double offset, bool fresh, const CameraModel& camera,
                                  const SightNoise& noise) {
  const GateBelief& belief = x.gates[static_cast<std::size_t>(sight.slot)];
  const Eigen::Matrix3d R_EG = rotation_z(belief.yaw_EG + (sight.behind ? kPi : 0.0));
  Eigen::Index count = 0;
  for (const Feature& feature : sight.features)
    count += feature.kind == Feature::Kind::kBar ? 1 : 2;
  if (count == 0) return std::nullopt;
  GateRows rows;
  rows.states = states_of(sight.slot);
  rows.residual.resize(count);
  rows.jacobian.resize(count, GateRows::kColumns);
  rows.noise.setZero(count, count);
  int row = 0;
  for (const Feature& feature : sight.features) {
    const Moment moment = moment_of(x, offset + x.delay + feature.late, camera);
    const bool corner = feature.kind != Feature::Kind::kBar;
    const bool good = corner ? put_corner(rows, row, feature, moment, x, belief, R_EG, gate)
                             : put_bar(rows, row, feature, moment, x, belief, R_EG, gate);
    if (!good) return std::nullopt;
    row += corner ? 2 : 1;
  }
  add_noise(rows, x, sight, fresh, camera, noise);
  rows.noise *= x.spread;
  if (!rows.residual.allFinite() || !rows.jacobian.allFinite()) return std::nullopt;
  return rows;
}

std::optional<Innovation> innovation(const Nominal& prior, const Covariance& P,
                                     const GateSight& sight, const GateShape& gate, double offset,
                                     bool fresh, const CameraModel& camera,
                                     const SightNoise& noise) {
  constexpr double kBent = 10.0;   // Above this NIS the linearisation may be to blame, ...
  constexpr double kLost = 300.0;  // ... above this one it hardly is. [estimate]
  constexpr double kSure = 0.25;   // Nor is it where the place is known so well [m]. [estimate]
  // An explanation farther from the belief than this is more likely another gate [m]. [ours: recorded
  // flights 5 and 9, whose gate is not the map's, ask for 1.9 and more; races that it saves for 0.6]
  constexpr double kFarthest = 1.2;
  const bool is_sure = P(kP, kP) + P(kP + 1, kP + 1) < 2.0 * squared(kSure);
  ErrorVector error = ErrorVector::Zero(P.rows());
  std::optional<Innovation> first, out;
  for (int i = 0; i < kIterations; ++i) {
    Nominal at = prior;
    if (i > 0) add(at, error);
    const auto rows = gate_rows(at, sight, gate, offset, fresh, camera, noise);
    if (!rows) return first;
    const auto next = innovation(P, *rows, error);
    if (!next) return first;
    out = next;
    if (i == 0) first = out;
    if (is_sure || out->nis < kBent || (i == 0 && out->nis > kLost)) break;
  }
  const bool is_near = error.segment<2>(kP).norm() < kFarthest;
  return is_near ? out : first;
}

bool correct_by_gate(Nominal& x, Covariance& P, const GateSight& sight, const GateShape& gate,
                     double offset, const CameraModel& camera, const SightNoise& noise) {
  const bool whole = sight.quality == GateSight::Quality::kWhole;
  if (whole && x.corner_of != face_of(sight)) forget_corner(x, P, face_of(sight), camera, noise);
  const Nominal prior = x;
  Nominal at = x;
  ErrorVector error = ErrorVector::Zero(P.rows());
  SpreadTransposed Wt;
  double spread_then = x.spread;
  for (int i = 0; i < kIterations; ++i) {
    const auto rows = gate_rows(at, sight, gate, offset, false, camera, noise);
    if (!rows) return false;
    if (!iterate(P, *rows, noise, whole ? &x.spread : nullptr, &spread_then, error, Wt))
      return false;
    at = prior;
    add(at, error);
  }
  x = at;
  x.spread = spread_then;
  narrow(P, Wt);
  return true;
}

}  // namespace gatefly::eskf
