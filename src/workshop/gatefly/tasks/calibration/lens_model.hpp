// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sensing/camera.hpp"

namespace gatefly::calibration {

/// The lenses of sensing/camera.hpp, the one with fewest parameters first.
enum class LensModel { kPinhole, kDhane, kKannalaBrandt, kBrownConrady };
inline constexpr std::array kLensModels{LensModel::kPinhole, LensModel::kDhane,
                                        LensModel::kKannalaBrandt, LensModel::kBrownConrady};

/// As camera.model in a configuration has it.
[[nodiscard]] std::string name_of(LensModel model);
[[nodiscard]] std::optional<LensModel> lens_model(const std::string& name);

/// fx, fy, cx, cy [px], then camera.distortion in its order.
[[nodiscard]] std::vector<std::string> parameter_names(LensModel model);

/// The flight code's lens. @param parameters  as many as parameter_names() has.
[[nodiscard]] AnyCamera lens_of(LensModel model, const Eigen::VectorXd& parameters);

/// A lens taken apart again.
struct LensParameters {
  LensModel model;
  Eigen::VectorXd parameters;
};
[[nodiscard]] LensParameters parameters_of(const AnyCamera& lens);

}  // namespace gatefly::calibration
