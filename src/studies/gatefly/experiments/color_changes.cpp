// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/color_changes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "gatefly/files/image_file.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::experiments {
namespace {

using Color = std::array<double, 3>;

/// Every pixel's R, G, B replaced by what `change` makes of it.
template <class Change>
UprightPicture pixel_by_pixel(UprightPicture picture, Change change) {
  for (std::size_t i = 0; i + 2 < picture.bytes.size(); i += 3) {
    const Color now = change(Color{double(picture.bytes[i]), double(picture.bytes[i + 1]),
                                   double(picture.bytes[i + 2])});
    for (std::size_t c = 0; c < 3; ++c) picture.bytes[i + c] = rounded(now[c]);
  }
  return picture;
}

/// Luma and the two chromas of a picture, each 0..255, line by line.
using Planes = std::array<std::vector<double>, 3>;

Planes planes_of(const UprightPicture& picture) {
  Planes planes;
  for (std::size_t i = 0; i + 2 < picture.bytes.size(); i += 3) {
    const Color ycc = ycc_of(
        {double(picture.bytes[i]), double(picture.bytes[i + 1]), double(picture.bytes[i + 2])});
    for (std::size_t c = 0; c < 3; ++c) planes[c].push_back(ycc[c]);
  }
  return planes;
}

UprightPicture of_planes(UprightPicture picture, const Planes& planes) {
  std::size_t pixel = 0;
  return pixel_by_pixel(std::move(picture), [&](const Color&) {
    const Color rgb = rgb_of({planes[0][pixel], planes[1][pixel], planes[2][pixel]});
    ++pixel;
    return rgb;
  });
}

/// Weighted sums of an odd number of neighbours along (du, dv).
std::vector<double> filtered(const std::vector<double>& plane, int width, int height,
                             const std::vector<double>& weights, int du, int dv) {
  const int reach = static_cast<int>(weights.size()) / 2;
  const auto value = [&](int u, int v) {
    return plane[static_cast<std::size_t>(std::clamp(v, 0, height - 1)) *
                     static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(std::clamp(u, 0, width - 1))];
  };
  std::vector<double> sums;
  sums.reserve(plane.size());
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      double sum = 0.0;
      for (int k = -reach; k <= reach; ++k)
        sum += weights[static_cast<std::size_t>(k + reach)] * value(u + k * du, v + k * dv);
      sums.push_back(sum);
    }
  return sums;
}

std::vector<double> bell(double sigma) {
  std::vector<double> weights;
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k)
    sum += weights.emplace_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  for (double& weight : weights) weight /= sum;
  return weights;
}

UprightPicture moved(const UprightPicture& picture, int pixels, int du, int dv) {
  const std::vector<double> weights(static_cast<std::size_t>(pixels), 1.0 / pixels);
  Planes planes = planes_of(picture);
  for (auto& plane : planes)
    plane = filtered(plane, picture.width, picture.height, weights, du, dv);
  return of_planes(picture, planes);
}

}  // namespace

UprightPicture gained(const UprightPicture& picture, const std::array<double, 3>& rgb_factors) {
  return pixel_by_pixel(picture, [&](Color rgb) {
    for (std::size_t c = 0; c < 3; ++c) rgb[c] *= rgb_factors[c];
    return rgb;
  });
}

UprightPicture with_gamma(const UprightPicture& picture, double gamma) {
  return pixel_by_pixel(picture, [&](Color rgb) {
    for (double& value : rgb) value = 255.0 * std::pow(value / 255.0, gamma);
    return rgb;
  });
}

UprightPicture saturated(const UprightPicture& picture, double factor) {
  return pixel_by_pixel(picture, [&](const Color& rgb) {
    const auto [y, cb, cr] = ycc_of(rgb);
    return rgb_of({y, 128.0 + factor * (cb - 128.0), 128.0 + factor * (cr - 128.0)});
  });
}

UprightPicture with_hue_turned(const UprightPicture& picture, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  const double c = std::cos(angle), s = std::sin(angle);
  return pixel_by_pixel(picture, [&](const Color& rgb) {
    const auto [y, cb, cr] = ycc_of(rgb);
    return rgb_of({y, 128.0 + c * (cb - 128.0) - s * (cr - 128.0),
                   128.0 + s * (cb - 128.0) + c * (cr - 128.0)});
  });
}

UprightPicture blurred(const UprightPicture& picture, double sigma_px, Blurred part) {
  const std::vector<double> weights = bell(sigma_px);
  Planes planes = planes_of(picture);
  for (std::size_t c = 0; c < 3; ++c) {
    if (part != Blurred::kAll && (part == Blurred::kLuma) != (c == 0)) continue;
    planes[c] = filtered(planes[c], picture.width, picture.height, weights, 1, 0);
    planes[c] = filtered(planes[c], picture.width, picture.height, weights, 0, 1);
  }
  return of_planes(picture, planes);
}

UprightPicture moved_across(const UprightPicture& picture, int pixels) {
  return moved(picture, pixels, 1, 0);
}

UprightPicture moved_down(const UprightPicture& picture, int pixels) {
  return moved(picture, pixels, 0, 1);
}

UprightPicture noisy(const UprightPicture& picture, double sigma) {
  sim::Stream noise{1, "picture noise"};
  return pixel_by_pixel(picture, [&](Color rgb) {
    for (double& value : rgb) value += sigma * noise.normal();
    return rgb;
  });
}

UprightPicture through_jpeg(const UprightPicture& picture, int quality,
                            files::ChromaSampling sampling) {
  files::ImageFile read =
      files::decoded_jpeg("changed picture", files::jpeg_of(picture.view(), quality, sampling));
  UprightPicture changed = picture;
  changed.format = read.format;
  changed.bytes = std::move(read.bytes);
  return changed;
}

}  // namespace gatefly::experiments
