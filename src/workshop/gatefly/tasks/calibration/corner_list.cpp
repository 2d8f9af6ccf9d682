// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/corner_list.hpp"

#include <cmath>
#include <cstddef>
#include <map>
#include <stdexcept>

#include "gatefly/files/csv.hpp"

namespace gatefly::calibration {
namespace {

/// Two columns with what their unit and their first number mean.
struct Pair {
  const char *first, *second;
  double scale, origin;
};

std::vector<Eigen::Vector2d> read_pairs(const files::Csv& csv, const std::filesystem::path& path,
                                        const Pair& one, const Pair& other) {
  const Pair& pair = csv.has(one.first) || !csv.has(other.first) ? one : other;
  if (!csv.has(pair.first) || !csv.has(pair.second))
    throw std::runtime_error(path.string() + ": has no columns " + one.first + "," + one.second +
                             " nor " + other.first + "," + other.second +
                             ": see gatefly calibrate --help");
  const auto first = csv.numbers(pair.first), second = csv.numbers(pair.second);
  std::vector<Eigen::Vector2d> pairs;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    const Eigen::Vector2d read{first[i], second[i]};
    for (const int k : {0, 1})
      if (!std::isfinite(read[k]))
        throw std::runtime_error(csv.place(i, k == 0 ? pair.first : pair.second) +
                                 ": must be a number");
    pairs.emplace_back(pair.scale * (read - Eigen::Vector2d::Constant(pair.origin)));
  }
  return pairs;
}

}  // namespace

BoardViews read_corner_list(const std::filesystem::path& path) {
  const files::Csv csv(path);
  const std::string key = csv.has("view") && !csv.has("image") ? "view" : "image";
  const auto images = csv.texts(key);
  const auto p_W = read_pairs(csv, path, {"X_m", "Y_m", 1.0, 0.0}, {"X_mm", "Y_mm", 1e-3, 0.0});
  const auto px =
      read_pairs(csv, path, {"u_px", "v_px", 1.0, 0.0}, {"u_px_1based", "v_px_1based", 1.0, 1.0});
  BoardViews views;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    const auto [place, is_new] = index.try_emplace(images[i], views.size());
    if (is_new) views.push_back({key == "view" ? "view " + images[i] : images[i], {}});
    views[place->second].corners.push_back({p_W[i], px[i]});
  }
  if (views.empty()) throw std::runtime_error(path.string() + ": holds no corner");
  return views;
}

void turn_upright(BoardViews& views, const Eigen::Vector2i& stored_size_px, int rotation_deg) {
  const Eigen::Vector2d last = stored_size_px.cast<double>() - Eigen::Vector2d::Ones();
  for (BoardView& view : views)
    for (BoardCorner& corner : view.corners) {
      const double u = corner.px.x(), v = corner.px.y();
      if (rotation_deg == 90) corner.px = {v, last.x() - u};
      if (rotation_deg == 180) corner.px = {last.x() - u, last.y() - v};
      if (rotation_deg == 270) corner.px = {last.y() - v, u};
    }
}

}  // namespace gatefly::calibration
