// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/lens_model.hpp"

#include <algorithm>
#include <cstddef>
#include <variant>

namespace gatefly::calibration {
namespace {

Eigen::VectorXd parameters(const Eigen::Vector2d& focal_px, const Eigen::Vector2d& center_px,
                           const std::vector<double>& distortion) {
  Eigen::VectorXd all(4 + static_cast<Eigen::Index>(distortion.size()));
  all << focal_px, center_px, Eigen::Map<const Eigen::VectorXd>(distortion.data(), all.size() - 4);
  return all;
}

LensParameters parts_of(const Pinhole& lens) {
  return {LensModel::kPinhole, parameters(lens.focal_px, lens.center_px, {})};
}
LensParameters parts_of(const DhaneFisheye& lens) {
  return {LensModel::kDhane, parameters(lens.focal_px, lens.center_px, {lens.k})};
}
LensParameters parts_of(const KannalaBrandt& lens) {
  const auto& k = lens.radial.coefficients();
  return {LensModel::kKannalaBrandt,
          parameters(lens.focal_px, lens.center_px, {k.begin(), k.end()})};
}
LensParameters parts_of(const BrownConrady& lens) {
  const auto d = lens.distortion();
  return {LensModel::kBrownConrady,
          parameters(lens.focal_px, lens.center_px, {d.begin(), d.end()})};
}

}  // namespace

std::string name_of(LensModel model) {
  switch (model) {
    case LensModel::kPinhole:
      return "pinhole";
    case LensModel::kDhane:
      return "dhane";
    case LensModel::kKannalaBrandt:
      return "kannala-brandt";
    case LensModel::kBrownConrady:
      break;
  }
  return "brown-conrady";
}

std::optional<LensModel> lens_model(const std::string& name) {
  const auto found = std::find_if(kLensModels.begin(), kLensModels.end(),
                                  [&](LensModel model) { return name_of(model) == name; });
  return found == kLensModels.end() ? std::nullopt : std::optional{*found};
}

std::vector<std::string> parameter_names(LensModel model) {
  std::vector<std::string> names{"fx", "fy", "cx", "cy"};
  const auto add = [&](std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  if (model == LensModel::kDhane) add({"k"});
  if (model == LensModel::kKannalaBrandt) add({"k1", "k2", "k3", "k4"});
  if (model == LensModel::kBrownConrady) add({"k1", "k2", "p1", "p2", "k3"});
  return names;
}

AnyCamera lens_of(LensModel model, const Eigen::VectorXd& p) {
  const Eigen::Vector2d focal_px = p.head<2>(), center_px = p.segment<2>(2);
  switch (model) {
    case LensModel::kPinhole:
      return {Pinhole{focal_px, center_px}};
    case LensModel::kDhane:
      return {DhaneFisheye{focal_px, center_px, p[4]}};
    case LensModel::kKannalaBrandt:
      return {KannalaBrandt{focal_px, center_px, RadialPolynomial{{p[4], p[5], p[6], p[7]}}}};
    case LensModel::kBrownConrady:
      break;
  }
  return {BrownConrady{focal_px, center_px, {p[4], p[5], p[6], p[7], p[8]}}};
}

LensParameters parameters_of(const AnyCamera& lens) {
  return std::visit([](const auto& model) { return parts_of(model); }, lens.model);
}

}  // namespace gatefly::calibration
