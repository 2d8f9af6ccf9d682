// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/lens_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Dense>

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::tuning {
namespace {

constexpr double kLeastSide = 24.0;  // px; shorter sides hardly bow
constexpr double kMostOff = 0.2;     // of the centre, of a picture that is cut out of a larger one
// The bend is angle², to which a side's sag is proportional while it is small. 1.5 times that of a
// lens of 150°: no bar bows more. [rad²]
constexpr double kMostBend = 1.5 * 2.62 * 2.62;

/// x(t) = (1 - t) a + t b + 4 t (1 - t) sag: how far beside its chord a bar's middle is [px].
struct Bow {
  Eigen::Vector3d is = Eigen::Vector3d::Zero();  // a, b, sag

  [[nodiscard]] static Eigen::Vector3d terms(double t) { return {1.0 - t, t, 4.0 * t * (1.0 - t)}; }
  [[nodiscard]] double at(double t) const { return is.dot(terms(t)); }
};

/// One side of a gate in the picture.
class SideInPicture {
 public:
  SideInPicture(const Image& image, const PixelEvidence& evidence, const Eigen::Vector2d& a,
                const Eigen::Vector2d& b, double bar_px)
      : image_{image},
        evidence_{evidence},
        a_{a},
        along_{b - a},
        inwards_{Eigen::Vector2d{-along_.y(), along_.x()}.normalized()},
        reach_{0.5 * bar_px + 2.5},
        stations_{std::clamp(static_cast<int>(along_.norm() / 3.0), 8, 64)} {}

  /// nullopt where too little of it shows, or it is no parabola.
  [[nodiscard]] std::optional<BowedSide> measured() const {
    Bow bow = brightest();
    std::optional<BowedSide> side;
    for (int pass = 0; pass < 3; ++pass) {
      side = fitted(bow);
      if (!side) return std::nullopt;
    }
    return side;
  }

 private:
  static constexpr double kEnd = 0.08;        // of the side: there the other bars cross
  static constexpr double kLeastShown = 0.6;  // of the stations
  static constexpr double kLeastError = 0.2, kMostError = 1.2;  // of a station [px]
  // Neighbours err alike: a bar's pixels are quantised, its picture is compressed in blocks.
  static constexpr double kAlike = 1.5;

  const Image& image_;
  const PixelEvidence& evidence_;
  Eigen::Vector2d a_, along_, inwards_;
  double reach_;
  int stations_;

  [[nodiscard]] double station(int j) const {
    return kEnd + (1.0 - 2.0 * kEnd) * (j + 0.5) / stations_;
  }
  [[nodiscard]] int evidence_at(double t, double beside) const {
    const Eigen::Vector2d p = a_ + t * along_ + beside * inwards_;
    const int u = static_cast<int>(std::lround(p.x())), v = static_cast<int>(std::lround(p.y()));
    return image_.contains(u, v) ? evidence_.at(u, v) : -1;
  }

  // The bow between the given corners with the most evidence along it, to either side alike: what
  // is looked for one way only is found.
  [[nodiscard]] Bow brightest() const {
    const Eigen::Vector2d middle{0.5 * (image_.width() - 1), 0.5 * (image_.height() - 1)};
    const double width = image_.width(), off = (a_ + 0.5 * along_ - middle).dot(inwards_);
    const double most =
        kMostBend / 3.0 * 0.25 * along_.squaredNorm() * std::abs(off) / (width * width);
    const int steps = std::min(40, static_cast<int>(most / std::max(1.0, 0.5 * reach_) + 0.999));
    Bow best;
    int most_evidence = -1 << 30;
    for (int k = -steps; k <= steps; ++k) {
      const double sag = steps > 0 ? most * k / steps : 0.0;
      int sum = -std::abs(k);  // of equals the straightest
      for (int j = 0; j < stations_; ++j)
        sum += evidence_at(station(j), 4.0 * station(j) * (1.0 - station(j)) * sag);
      if (sum > most_evidence) most_evidence = sum, best.is = {0.0, 0.0, sag};
    }
    return best;
  }

  // Least squares of the bar's middle at every station that shows it, near where it was.
  [[nodiscard]] std::optional<BowedSide> fitted(Bow& bow) const {
    std::vector<Eigen::Vector3d> terms;
    std::vector<double> places;
    const int reach = static_cast<int>(reach_ + 0.5);
    for (int j = 0; j < stations_; ++j) {
      const double t = station(j), here = bow.at(t);
      int sum = 0, moment = 0;
      for (int o = -reach; o <= reach; ++o) {
        const int shown = std::max(0, evidence_at(t, here + o));
        sum += shown, moment += shown * o;
      }
      if (sum <= 8) continue;
      terms.push_back(Bow::terms(t));
      places.push_back(here + static_cast<double>(moment) / sum);
    }
    const auto shown = static_cast<double>(places.size());
    if (shown < kLeastShown * stations_) return std::nullopt;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    double error = 1.0;
    for (int pass = 0; pass < 4; ++pass) {
      information.setZero();
      Eigen::Vector3d moment = Eigen::Vector3d::Zero();
      double left = 0.0, weights = 0.0;
      for (std::size_t j = 0; j < places.size(); ++j) {
        const double residual = places[j] - terms[j].dot(bow.is), z = residual / error,
                     weight = 1.0 / (1.0 + z * z);
        information += weight * terms[j] * terms[j].transpose();
        moment += weight * residual * terms[j];
        left += weight * residual * residual, weights += weight;
      }
      const Eigen::Vector3d step = information.ldlt().solve(moment);
      if (!step.allFinite()) return std::nullopt;
      bow.is += step;
      error = std::clamp(std::sqrt(left / weights), kLeastError, 4.0);
    }
    if (error > kMostError) return std::nullopt;
    const double width = image_.width(),
                 sigma = kAlike * error * std::sqrt(information.inverse()(2, 2));
    const Eigen::Vector2d middle{0.5 * (image_.width() - 1), 0.5 * (image_.height() - 1)};
    return BowedSide{.from = (a_ + bow.is[0] * inwards_ - middle) / width,
                     .to = (a_ + along_ + bow.is[1] * inwards_ - middle) / width,
                     .sag = bow.is[2] / width,
                     .sigma = sigma / width};
  }
};

/// How far sides should bow before equidistant lenses, and how far each is from it.
class Misfit {
 public:
  explicit Misfit(std::span<const BowedSide> sides) : sides_{sides} {}

  using Parameters = Eigen::Vector3d;  // b = angle² [rad²], centre [widths]

  /// The misfit of every side, in standard deviations.
  [[nodiscard]] std::vector<double> residuals(const Parameters& p) const {
    constexpr double kLensError = 0.04;  // of the sag: no lens is quite equidistant
    const double angle = std::sqrt(std::max(0.0, p[0]));
    const PictureLens lens = equidistant_lens(angle, p.tail<2>());
    const LensBend bend{lens};
    const SideCurves curves{bend, Image{}};
    const double width = std::max(1, lens.width);
    const Eigen::Vector2d middle{0.5 * (lens.width - 1), 0.5 * (lens.height - 1)};
    std::vector<double> left;
    left.reserve(sides_.size());
    for (const BowedSide& side : sides_) {
      const Eigen::Vector2d a = width * side.from + middle, b = width * side.to + middle,
                            inwards = Eigen::Vector2d{a.y() - b.y(), b.x() - a.x()}.normalized();
      const double bow = curves.sag(a, b).dot(inwards) / width;
      left.push_back((side.sag - bow) / std::hypot(side.sigma, kLensError * side.sag));
    }
    return left;
  }
  /// Outliers count as the logarithm of their square.
  [[nodiscard]] static double cost_of(const std::vector<double>& residuals) {
    double cost = 0.0;
    for (const double z : residuals) cost += kFew * kFew * std::log1p(z * z / (kFew * kFew));
    return cost;
  }
  [[nodiscard]] static double weight(double z) { return 1.0 / (1.0 + z * z / (kFew * kFew)); }

  /// How many times its sigma a side is off, by the median; at least 1.
  [[nodiscard]] static double scale_of(std::vector<double> residuals) {
    constexpr double kNormal = 0.6745;  // median of a normal error without its sign
    if (residuals.empty()) return 1.0;
    for (double& z : residuals) z = std::abs(z);
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    return std::max(1.0, *middle / kNormal);
  }

  struct Solution {
    Parameters is = Parameters::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  };
  /// Gauss and Newton, from a start near by. What the gates differ by is part of the covariance.
  /// @param free  1: the bend alone, 3: the centre as well.
  [[nodiscard]] Solution solved(Parameters at, int free) const {
    constexpr double kCenterSigma = 0.08;  // of lenses off their picture's middle [widths; ours]
    const Parameters step{0.05, 0.005, 0.005};
    Eigen::MatrixXd information;
    std::map<std::size_t, Eigen::VectorXd> by_gate;
    for (int pass = 0; pass < 6; ++pass) {
      const auto z = residuals(at);
      std::vector<std::vector<double>> beside;
      for (int k = 0; k < free; ++k)
        beside.push_back(residuals(at + step[k] * Parameters::Unit(k)));
      information = Eigen::MatrixXd::Zero(free, free);
      Eigen::VectorXd moment = Eigen::VectorXd::Zero(free);
      for (int k = 1; k < free; ++k)
        information(k, k) = 1.0 / (kCenterSigma * kCenterSigma),
                       moment[k] = -at[k] * information(k, k);
      by_gate.clear();
      for (std::size_t i = 0; i < sides_.size(); ++i) {
        Eigen::VectorXd slope(free);
        for (int k = 0; k < free; ++k)
          slope[k] = (beside[static_cast<std::size_t>(k)][i] - z[i]) / step[k];
        const double w = weight(z[i]);
        information += w * slope * slope.transpose();
        moment -= w * z[i] * slope;
        auto& of_gate =
            by_gate.try_emplace(sides_[i].gate, Eigen::VectorXd::Zero(free)).first->second;
        of_gate += w * z[i] * slope;
      }
      const Eigen::VectorXd move = information.ldlt().solve(moment);
      if (!move.allFinite()) break;
      at.head(free) += move;
      at[0] = std::clamp(at[0], 0.0, kMostBend);
      for (int k = 1; k < free; ++k) at[k] = std::clamp(at[k], -kMostOff, kMostOff);
    }
    Solution solution{.is = at, .covariance = Eigen::Matrix3d::Zero()};
    const Eigen::MatrixXd stated = information.inverse();
    Eigen::MatrixXd differ = Eigen::MatrixXd::Zero(free, free);
    for (const auto& [gate, s] : by_gate) differ += s * s.transpose();
    const auto gates = static_cast<double>(by_gate.size());
    const double scale = scale_of(residuals(at));
    const Eigen::MatrixXd seen = gates / std::max(1.0, gates - free) * stated * differ * stated;
    for (int k = 0; k < free; ++k)  // whichever is larger: few gates may agree by chance
      solution.covariance(k, k) = std::max(scale * scale * stated(k, k), seen(k, k));
    return solution;
  }

 private:
  static constexpr double kFew = 2.0;
  std::span<const BowedSide> sides_;
};

/// Whether the lens' centre is clearly not the picture's middle: by all gates, and by every second one
/// and the others alike.
bool is_known(const Misfit::Solution& off_middle, std::span<const BowedSide> sides) {
  constexpr double kSure = 4.0, kSureOfHalf = 2.0, kLeastOff = 0.015;
  const auto times_sigma = [](const Misfit::Solution& s) {
    return s.is.tail<2>().cwiseQuotient(s.covariance.diagonal().tail<2>().cwiseSqrt()).norm();
  };
  if (!(times_sigma(off_middle) > kSure) || !(off_middle.is.tail<2>().norm() > kLeastOff))
    return false;
  std::array<std::vector<BowedSide>, 2> halves;
  for (const BowedSide& side : sides) halves[side.gate % 2].push_back(side);
  std::array<Eigen::Vector2d, 2> centers;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto half = Misfit{halves[k]}.solved(off_middle.is, 3);
    if (!(times_sigma(half) > kSureOfHalf)) return false;
    centers[k] = half.is.tail<2>();
  }
  return (centers[0] - centers[1]).norm() < 0.5 * off_middle.is.tail<2>().norm();
}

}  // namespace

std::vector<BowedSide> bowed_sides(const Image& image, const PixelEvidence& evidence,
                                   const Quad& bars_px, double bar) {
  std::vector<BowedSide> sides;
  const double bar_px = bar * std::sqrt(std::abs(area(bars_px)));
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = bars_px[i], &b = bars_px[(i + 1) % 4];
    if (!((b - a).norm() >= kLeastSide)) continue;
    if (const auto side = SideInPicture{image, evidence, a, b, bar_px}.measured())
      sides.push_back(*side);
  }
  return sides;
}

PictureLens GateLens::picture_lens() const {
  if (says == Says::kNothing) return {};
  return equidistant_lens(says == Says::kBent ? angle : 0.0, center);
}

GateLens fit_lens(std::span<const BowedSide> sides) {
  constexpr int kLeastGates = 4;
  constexpr double kSure = 3.0;                 // standard deviations
  constexpr double kStraight = 45.0 * kDegree;  // a side of half the width bows by .2 % of it
  // No lens is quite equidistant, no bar's image quite a parabola. [rendered seeds: 0 to 4 % low]
  constexpr double kModel = 0.02;
  GateLens lens{.sides = static_cast<int>(sides.size())};
  std::vector<std::size_t> gates;
  for (const BowedSide& side : sides) gates.push_back(side.gate);
  std::sort(gates.begin(), gates.end());
  lens.gates = static_cast<int>(std::unique(gates.begin(), gates.end()) - gates.begin());
  if (lens.gates < kLeastGates) return lens;

  const Misfit misfit{sides};
  constexpr int kSteps = 40;
  double best = 0.0, least = 1e300;
  const double without = Misfit::cost_of(misfit.residuals(Eigen::Vector3d::Zero()));
  for (int k = 0; k <= kSteps; ++k) {
    const double b = kMostBend * k / kSteps;
    const double cost = k == 0 ? without : Misfit::cost_of(misfit.residuals({b, 0, 0}));
    if (cost < least) least = cost, best = b;
  }
  const auto alone = misfit.solved({best, 0, 0}, 1);
  double bend = alone.is[0], sigma = std::sqrt(alone.covariance(0, 0));
  if (bend > kSure * sigma) {
    const auto off_middle = misfit.solved(alone.is, 3);
    lens.center_sigma = off_middle.covariance.diagonal().tail<2>().cwiseSqrt();
    if (is_known(off_middle, sides)) {
      lens.knows_center = true, lens.center = off_middle.is.tail<2>();
      bend = off_middle.is[0], sigma = std::sqrt(off_middle.covariance(0, 0));
    }
  }
  lens.widest = std::sqrt(bend + 2.0 * sigma);
  const double gained =
      without - Misfit::cost_of(misfit.residuals({bend, lens.center.x(), lens.center.y()}));
  if (lens.widest < kStraight) {
    lens.says = GateLens::Says::kStraight;
  } else if (bend > kSure * sigma && gained > kSure * kSure) {
    lens.says = GateLens::Says::kBent;
    lens.angle = std::sqrt(bend);
    lens.angle_sigma = std::hypot(0.5 * sigma / lens.angle, kModel * lens.angle);
  }
  if (lens.says != GateLens::Says::kBent) lens.center.setZero(), lens.knows_center = false;
  return lens;
}

}  // namespace gatefly::tuning
