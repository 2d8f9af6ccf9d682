// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/lens_bend.hpp"

#include <cmath>
#include <variant>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kWidestRay = 2.6;  // rays up to so far from the axis [rad]
constexpr double kBeyond = 1.75;  // the tables reach so many times as far as the picture's corners
// An angle that grows so much faster with the radius than in the middle is not the lens, it is the
// end of its polynomial.
constexpr double kSteepest = 3.0;
constexpr double kStraight = 0.1;  // what bends less is straight [px]

/// The lens without its tangential part, of focal length 1.
struct Radial {
  Eigen::Vector2d focal_px, center_px;
  AnyCamera unit;

  explicit Radial(const AnyCamera& lens) {
    std::visit([this](const auto& model) { take(model); }, lens.model);
  }
  template <class Model>
  void take(Model model) {
    focal_px = model.focal_px, center_px = model.center_px;
    model.focal_px = {1, 1}, model.center_px = {0, 0};
    unit = AnyCamera{model};
  }
  void take(const BrownConrady& model) {
    focal_px = model.focal_px, center_px = model.center_px;
    auto k = model.distortion();
    k[2] = k[3] = 0.0;
    unit = AnyCamera{BrownConrady{{1, 1}, {0, 0}, k}};
  }

  /// From the axis, of what is drawn at radius r [rad].
  [[nodiscard]] std::optional<double> angle(double r) const {
    const auto bearing = unit.bearing({r, 0.0});
    return bearing ? std::optional{gatefly::atan2(bearing->x(), bearing->z())} : std::nullopt;
  }
};

/// Angles at even radii; where the model ends they go on as they did, up to kWidestRay.
class Angles {
 public:
  Angles(const Radial& lens, double most) : step_{most / kCount} {
    angles_.reserve(kCount + 1);
    angles_.push_back(0.0);
    const double at_first = lens.angle(step_).value_or(step_);
    double slope = at_first;
    bool model = true;
    for (int i = 1; i <= kCount; ++i) {
      const double before = angles_.back();
      const auto now = model ? lens.angle(i * step_) : std::nullopt;
      model = now && *now - before<kSteepest * at_first&& * now> before;
      if (model) slope = *now - before;
      angles_.push_back(std::min(kWidestRay, before + slope));
    }
  }

  [[nodiscard]] double widest() const { return angles_.back(); }
  [[nodiscard]] double angle(double r) const {
    const double at = std::min(r / step_, kCount - 1e-9);
    const auto k = static_cast<std::size_t>(at);
    return angles_[k] + (at - static_cast<double>(k)) * (angles_[k + 1] - angles_[k]);
  }
  [[nodiscard]] double radius(double angle) const {
    const auto above = std::upper_bound(angles_.begin() + 1, angles_.end() - 1, angle);
    const double high = *above, low = *(above - 1);
    return step_ * (static_cast<double>(above - angles_.begin() - 1) +
                    (angle - low) / std::max(1e-12, high - low));
  }

 private:
  static constexpr int kCount = 2048;

  double step_;
  std::vector<double> angles_;
};

}  // namespace

LensBend::LensBend(const PictureLens& lens)
    : width_{lens.width},
      height_{lens.height},
      known_{lens.model.has_value()},
      any_shape_{lens.any_shape} {
  if (!lens.model || std::holds_alternative<Pinhole>(lens.model->model)) return;
  const Radial radial{*lens.model};
  center_px_ = radial.center_px, per_focal_ = radial.focal_px.cwiseInverse();
  // Without a known picture size the lens is taken to be in the picture's middle.
  const Eigen::Vector2d size = width_ > 0 && height_ > 0 ? Eigen::Vector2d(width_, height_)
                                                         : Eigen::Vector2d{2.0 * center_px_},
                        corner = center_px_.cwiseMax(size - center_px_).cwiseProduct(per_focal_);
  const double most = kBeyond * corner.norm();
  if (!(most > 0.0 && most < 100.0)) return;
  const Angles angles{radial, most};

  rays_per_unit_ = kEntries / (most * most);
  for (int k = 0; k <= kEntries; ++k) {
    const double r = std::sqrt(std::max(1e-12, k / rays_per_unit_));
    const auto [sine, cosine] = sincos(angles.angle(r));
    rays_.push_back({sine / r, cosine});
  }
  pixels_per_unit_ = kEntries / (1.0 - gatefly::cos(angles.widest()));
  for (int k = 0; k <= kEntries; ++k) {
    const double cosine = 1.0 - std::max(1e-12, k / pixels_per_unit_),
                 sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    radii_.push_back(angles.radius(gatefly::atan2(sine, cosine)) / sine);
  }

  // Bars along the picture's borders bend most.
  const Image any{};
  double most_sag = 0.0;
  SideCurves curves{*this, any};
  const std::array<Eigen::Vector2d, 4> corners{
      {{0, 0}, {size.x() - 1, 0}, {size.x() - 1, size.y() - 1}, {0, size.y() - 1}}};
  for (std::size_t i = 0; i < 4; ++i)
    most_sag = std::max(most_sag, curves.sag(corners[i], corners[(i + 1) % 4]).norm());
  if (most_sag < kStraight) rays_.clear(), radii_.clear();
}

std::optional<double> LensBend::scale_of(const Image& image) const {
  if (width_ == 0 || height_ == 0 || image.empty()) return 1.0;
  const double across = static_cast<double>(width_) / image.width();
  if (any_shape_) return across;
  // A height that was halved is rounded.
  const bool same_shape = std::abs(height_ - across * image.height()) <= std::max(1.0, across);
  return same_shape ? std::optional{across} : std::nullopt;
}

Eigen::Vector2d LensBend::origin_in(const Image& image, double scale) const {
  if (!any_shape_ || image.empty()) return {-0.5, -0.5};
  // The middles of both lie on each other.
  return {0.5 * (width_ - 1 - scale * image.width()), 0.5 * (height_ - 1 - scale * image.height())};
}

PictureLens equidistant_lens(double angle_across, const Eigen::Vector2d& center) {
  constexpr int kWidth = 640, kHeight = 480;  // any will do
  if (!(angle_across > 0.0)) return {.model = AnyCamera{Pinhole{}}};
  KannalaBrandt lens;
  lens.focal_px = Eigen::Vector2d::Constant(kWidth / angle_across);
  lens.center_px = Eigen::Vector2d{0.5 * (kWidth - 1), 0.5 * (kHeight - 1)} + kWidth * center;
  return {.model = AnyCamera{lens}, .width = kWidth, .height = kHeight, .any_shape = true};
}

// The corners are λ_i times their rays, with those of a parallelogram: λ0 r0 + λ2 r2 = λ1 r1 + λ3
// r3.
Quad SideCurves::scaled(const Quad& quad, double factor) const {
  const auto as_drawn = [&] { return gatefly::scaled(quad, factor); };
  if (bend_ == nullptr) return as_drawn();
  std::array<Eigen::Vector3d, 4> corner;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray = bend_->ray(to_lens(quad[i]));
    if (!ray) return as_drawn();
    corner[i] = *ray;
  }
  const auto det = [&](std::size_t i, std::size_t j, std::size_t k) {
    return corner[i].dot(corner[j].cross(corner[k]));
  };
  const double d = det(1, 3, 2);
  const std::array<double, 4> lambda{1.0, det(0, 3, 2) / d, -det(1, 3, 0) / d, det(1, 0, 2) / d};
  for (const double l : lambda)
    if (!(l > 0.3 && l < 3.0)) return as_drawn();  // no square, or almost a point
  Eigen::Vector3d middle{0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) corner[i] *= lambda[i], middle += 0.25 * corner[i];
  Quad out;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto px = bend_->pixel(middle + factor * (corner[i] - middle));
    if (!px) return as_drawn();
    out[i] = to_cells(*px);
  }
  return out;
}

}  // namespace gatefly
