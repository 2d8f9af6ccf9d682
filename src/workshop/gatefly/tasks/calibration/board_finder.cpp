// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/board_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "gatefly/files/text.hpp"

namespace gatefly::calibration {
namespace {

using Corners = std::vector<cv::Point2f>;

cv::Mat grey(const Image& picture) {
  cv::Mat mat(picture.height(), picture.width(), CV_8UC1);
  for (int v = 0; v < picture.height(); ++v)
    for (int u = 0; u < picture.width(); ++u) mat.at<std::uint8_t>(v, u) = picture.at(u, v).y;
  return mat;
}

/// The board and how many corners it really has: the finder grows a grid as far as it goes.
Corners find_sector_based(const cv::Mat& picture, const cv::Size& pattern, cv::Size& seen) {
  Corners corners;
  cv::Mat meta;
  seen = {};
  const int flags = cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY | cv::CALIB_CB_LARGER;
  if (!cv::findChessboardCornersSB(picture, pattern, corners, flags, meta)) return {};
  seen = meta.size();
  return corners;
}

Corners find_classic(const cv::Mat& picture, const cv::Size& pattern) {
  Corners corners;
  const int flags =
      cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  return cv::findChessboardCorners(picture, pattern, corners, flags) ? corners : Corners{};
}

/// The smallest distance between neighbours in a row [px].
double spacing_px(const Corners& corners, const cv::Size& pattern) {
  double least = 1e9;
  for (int row = 0; row < pattern.height; ++row)
    for (int column = 0; column + 1 < pattern.width; ++column) {
      const cv::Point2f step = corners[static_cast<std::size_t>(row * pattern.width + column + 1)] -
                               corners[static_cast<std::size_t>(row * pattern.width + column)];
      least = std::min(least, static_cast<double>(std::hypot(step.x, step.y)));
    }
  return least;
}

void refine(const cv::Mat& picture, Corners& corners, const cv::Size& pattern) {
  // no neighbour within
  const int half = std::clamp(static_cast<int>(0.4 * spacing_px(corners, pattern)), 2, 8);
  cv::cornerSubPix(picture, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3});
}

BoardView view_of(const Corners& corners, const std::string& name, const BoardPattern& pattern,
                  const cv::Size& size) {
  BoardView view{name, {}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto column = static_cast<double>(static_cast<int>(i) % size.width);
    const auto row = static_cast<double>(static_cast<int>(i) / size.width);
    view.corners.push_back(
        {{pattern.square * column, pattern.square * row}, {corners[i].x, corners[i].y}});
  }
  return view;
}

bool same(const cv::Size& a, const cv::Size& b) {
  return a == b || a == cv::Size(b.height, b.width);
}

/// The value that this part of all pixels does not exceed.
double quantile(const cv::Mat& picture, double part) {
  std::vector<float> values;
  picture.reshape(1, 1).convertTo(values, CV_32F);
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

/// How far the sharpest edges need from dark to bright [px], across or down, whichever is worse: a
/// motion blurs one of the two.
double edge_width_px(const cv::Mat& picture) {
  const double range = quantile(picture, 0.99) - quantile(picture, 0.01);
  double widest = 0.0;
  for (const int across : {0, 1}) {
    cv::Mat slope;
    cv::Sobel(picture, slope, CV_32F, across, 1 - across, 3, 1.0 / 8.0);  // grey levels a pixel
    widest = std::max(widest, range / std::max(quantile(cv::abs(slope), 0.999), 1e-3));
  }
  return widest;
}

/// Why there is no board, as far as that can be seen.
std::string diagnosis(const cv::Mat& picture, const BoardPattern& pattern,
                      std::optional<BoardPattern>& other) {
  constexpr double kLeastContrast = 10.0;  // grey levels; sensor noise alone has less
  const double contrast = quantile(picture, 0.99) - quantile(picture, 0.01);
  if (contrast < kLeastContrast)
    return "shows nothing: all its grey levels are within " + files::text_of(contrast, 3) +
           " of 255";
  constexpr double kBlurredPx = 12.0;  // sharp pictures have 2-4 px
  if (const double width = edge_width_px(picture); width > kBlurredPx)
    return "blurred: its sharpest edges are " + files::text_of(width, 2) + " px wide";
  cv::Size seen;
  if (!find_sector_based(picture, {3, 3}, seen).empty() &&
      !same(seen, {pattern.columns, pattern.rows})) {
    other = BoardPattern{std::max(seen.width, seen.height), std::min(seen.width, seen.height),
                         pattern.square};
    if (other->columns * other->rows < pattern.columns * pattern.rows)
      return "only " + other->text() + " of " + pattern.text() + " inner corners can be seen";
    return "shows " + other->text() + " inner corners, not " + pattern.text();
  }
  return "no board of " + pattern.text() +
         " inner corners seen: hidden in part, too small, or not sharp";
}

}  // namespace

BoardSearch find_board(const Image& picture, const std::string& name, const BoardPattern& pattern) {
  const cv::Mat mat = grey(picture);
  const cv::Size size{pattern.columns, pattern.rows};
  cv::Size seen;
  Corners corners = find_sector_based(mat, size, seen);
  // Tilted squares pull the finder's own corners: of a drawn board, 0.08 px instead of 0.03, and 1
  // % of focal length.
  if (!corners.empty()) refine(mat, corners, seen);
  if (!corners.empty() && same(seen, size))
    return {.view = view_of(corners, name, pattern, seen), .reason = {}, .other = {}};
  if (!corners.empty()) {
    const BoardPattern other{std::max(seen.width, seen.height), std::min(seen.width, seen.height),
                             pattern.square};
    return {.view = {},
            .reason = "shows " + other.text() + " inner corners, not " + pattern.text(),
            .other = other};
  }
  corners = find_classic(mat, size);
  if (!corners.empty()) {
    refine(mat, corners, size);
    return {.view = view_of(corners, name, pattern, size), .reason = {}, .other = {}};
  }
  BoardSearch nothing;
  nothing.reason = diagnosis(mat, pattern, nothing.other);
  return nothing;
}

}  // namespace gatefly::calibration
