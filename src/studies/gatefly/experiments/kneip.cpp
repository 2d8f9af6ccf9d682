// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/kneip.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <unsupported/Eigen/Polynomials>

#include "gatefly/geometry/gate_corners.hpp"

namespace gatefly::experiments {
namespace {

using Three = std::array<Eigen::Vector3d, 3>;

struct CameraInG {
  Eigen::Matrix3d R_GC;
  Eigen::Vector3d p_GC;
};

/// Coefficients, constant first.
template <int A, int B>
Eigen::Matrix<double, A + B - 1, 1> product(const Eigen::Matrix<double, A, 1>& a,
                                            const Eigen::Matrix<double, B, 1>& b) {
  Eigen::Matrix<double, A + B - 1, 1> c = Eigen::Matrix<double, A + B - 1, 1>::Zero();
  for (int i = 0; i < A; ++i) c.template segment<B>(i) += a(i) * b;
  return c;
}

/// Rows: x along `first`, z across `first` and `second`.
Eigen::Matrix3d axes_along(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Eigen::Matrix3d axes;
  axes.row(0) = first.normalized();
  axes.row(2) = first.cross(second).normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes;
}

/// All poses from which three points show in three directions. The plane through the camera and the
/// first two points is turned by θ about their connection; the camera sees the first at the angle α
/// from it. With x = cos θ the third point gives cot α = a(x) / b(x) and one more equation, a
/// quartic in x.
std::vector<CameraInG> p3p(Three bearings, Three points, bool complex_roots) {
  Eigen::Matrix3d T = axes_along(bearings[0], bearings[1]);
  if (T.row(2).dot(bearings[2]) > 0.0) {  // so that 0 <= θ <= π
    std::swap(bearings[0], bearings[1]), std::swap(points[0], points[1]);
    T = axes_along(bearings[0], bearings[1]);
  }
  const Eigen::Matrix3d N = axes_along(points[1] - points[0], points[2] - points[0]);
  const Eigen::Vector3d f = T * bearings[2], p = N * (points[2] - points[0]);
  const double d = (points[1] - points[0]).norm();
  const double cot_beta = bearings[0].dot(bearings[1]) / bearings[0].cross(bearings[1]).norm();
  const double ratio = f.x() / f.y(), slope = f.y() / f.z();

  const Eigen::Vector2d a{ratio * p.x() - d * cot_beta, p.y()}, b{d - p.x(), ratio * p.y()};
  // (p_x b - x p_y a)² = slope² p_y² (1 - x²)(a² + b²)
  Eigen::Vector3d left = product<2, 2>(Eigen::Vector2d{0.0, -p.y()}, a);
  left.head<2>() += p.x() * b;
  const Eigen::Vector3d sum = product<2, 2>(a, a) + product<2, 2>(b, b);
  const double weight = slope * slope * p.y() * p.y();
  const Eigen::Matrix<double, 5, 1> quartic =
      product<3, 3>(left, left) - product<3, 3>(weight * Eigen::Vector3d{1.0, 0.0, -1.0}, sum);
  if (!quartic.allFinite() || quartic(4) == 0.0) return {};

  constexpr double kReal = 1e-7;  // an imaginary part that is rounding
  std::vector<CameraInG> found;
  for (const std::complex<double>& root : Eigen::PolynomialSolver<double, 4>{quartic}.roots()) {
    const double x = root.real();
    if (!(std::abs(x) <= 1.0) || (!complex_roots && std::abs(root.imag()) > kReal)) continue;
    const double sin_theta = std::sqrt(1.0 - x * x);
    const Eigen::Vector2d along = Eigen::Vector2d{a(0) + a(1) * x, b(0) + b(1) * x}.normalized();
    const double sin_alpha = std::abs(along.y()),
                 cos_alpha = along.y() < 0.0 ? -along.x() : along.x();
    Eigen::Matrix3d Q;
    Q << -cos_alpha, -sin_alpha * x, -sin_alpha * sin_theta,  //
        sin_alpha, -cos_alpha * x, -cos_alpha * sin_theta,    //
        0.0, -sin_theta, x;
    const Eigen::Vector3d camera = -d * (sin_alpha * cot_beta + cos_alpha) * Q.row(0);
    if (camera.allFinite())
      found.push_back({N.transpose() * Q.transpose() * T, points[0] + N.transpose() * camera});
  }
  return found;
}

}  // namespace

std::optional<Eigen::Vector3d> camera_by_kneip(const Quad& corners, double focal_px, double side,
                                               const KneipRule& rule) {
  const auto points = gate_corners_G(side);
  std::array<Eigen::Vector3d, 4> bearings;
  for (std::size_t i = 0; i < 4; ++i)
    bearings[i] = Eigen::Vector3d{corners[i].x(), corners[i].y(), focal_px}.normalized();

  const auto error_of = [&](const CameraInG& pose) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d q = pose.R_GC.transpose() * (points[i] - pose.p_GC);
      const Eigen::Vector2d off = focal_px * q.head<2>() / q.z() - corners[i];
      sum += rule.squares ? off.squaredNorm() : off.norm();
    }
    return sum;
  };
  std::optional<Eigen::Vector3d> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < static_cast<std::size_t>(rule.triples); ++first) {
    const std::size_t second = (first + 1) % 4, third = (first + 2) % 4;
    for (const CameraInG& pose :
         p3p({bearings[first], bearings[second], bearings[third]},
             {points[first], points[second], points[third]}, rule.complex_roots)) {
      const double error = error_of(pose);
      if (error < least) least = error, best = pose.p_GC;
    }
  }
  return best;
}

}  // namespace gatefly::experiments
