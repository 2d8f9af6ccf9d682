// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/gate_appearance.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/files/quantile.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {
namespace {

constexpr int kAlong = 24;         // places along a side
constexpr double kFrom = 0.08;     // of the side that its ends leave out
constexpr double kColored = 10.0;  // Cr - Cb above what is beside, to count as the gate's colour
constexpr double kStrongY = 25.0, kStrongCr = 8.0;  // step between neighbours that makes an edge

struct Yuvf {
  double y = 0.0, cb = 0.0, cr = 0.0;
};

Yuvf at(const Image& image, const Eigen::Vector2d& px) {
  const double x = std::clamp(px.x(), 0.0, image.width() - 1.001),
               y = std::clamp(px.y(), 0.0, image.height() - 1.001);
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  Yuvf sum;
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const double w = (i != 0 ? x - u : 1 - x + u) * (j != 0 ? y - v : 1 - y + v);
      const Yuv c = image.at(u + i, v + j);
      sum.y += w * c.y, sum.cb += w * c.u, sum.cr += w * c.v;
    }
  return sum;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return files::quantile(values, 0.5);
}

/// The colour across a side at one place, every half pixel, out to a fifth of the gate.
struct Across {
  std::vector<double> excess;  ///< Cr - Cb.
  double beside_cb = 0.0, beside_cr = 0.0, bar_cb = 0.0, bar_cr = 0.0;
};

Across across(const Image& image, const Eigen::Vector2d& on, const Eigen::Vector2d& out,
              double reach) {
  Across a;
  std::vector<double> cb, cr;
  std::vector<Yuvf> profile;
  const int half = std::max(4, static_cast<int>(2.0 * reach));
  for (int i = -half; i <= half; ++i) profile.push_back(at(image, on + 0.5 * i * out));
  for (int i = 0; i <= 2 * half; ++i) {
    const Yuvf& c = profile[static_cast<std::size_t>(i)];
    a.excess.push_back(c.cr - c.cb);
    if (std::abs(i - half) > half / 2 + 2) cb.push_back(c.cb), cr.push_back(c.cr);
  }
  a.beside_cb = median(cb), a.beside_cr = median(cr);
  // The label is a pixel or two off: the bar is where the colour is strongest near it.
  const auto begin = a.excess.begin() + half / 2, end = a.excess.begin() + 3 * half / 2 + 1;
  const auto best = static_cast<std::size_t>(std::max_element(begin, end) - a.excess.begin());
  a.bar_cb = profile[best].cb, a.bar_cr = profile[best].cr;
  return a;
}

/// Width of the excess at half its height [px]; 0 where there is none.
double width_at_half(const Across& a) {
  const double ground = a.beside_cr - a.beside_cb, top = a.bar_cr - a.bar_cb;
  if (top - ground < kColored) return 0.0;
  double width = 0.0;
  for (const double e : a.excess) width += e - ground > 0.5 * (top - ground) ? 0.5 : 0.0;
  return width;
}

void look_along_bars(const Image& image, const Quad& gate, GateAppearance& to) {
  std::vector<double> widths, cb, cr, excess;
  to.worst_side = 1.0;
  for (std::size_t s = 0; s < 4; ++s) {
    const Eigen::Vector2d from = gate[s], along = gate[(s + 1) % 4] - from;
    const Eigen::Vector2d out = Eigen::Vector2d{along.y(), -along.x()}.normalized();
    double sum = 0.0, squares = 0.0;
    int colored = 0;
    for (int i = 0; i < kAlong; ++i) {
      const double t = kFrom + (1.0 - 2.0 * kFrom) * i / (kAlong - 1);
      const Across a = across(image, from + t * along, out, std::max(4.0, 0.14 * to.side_px));
      const double is = a.bar_cr - a.bar_cb;
      sum += is / kAlong, squares += is * is / kAlong;
      colored += is - (a.beside_cr - a.beside_cb) > kColored;
      if (const double w = width_at_half(a); w > 0.0) widths.push_back(w);
      cb.push_back(a.bar_cb - a.beside_cb), cr.push_back(a.bar_cr - a.beside_cr);
      excess.push_back(is);
    }
    to.uneven += 0.25 * std::sqrt(std::max(0.0, squares - sum * sum));
    to.worst_side = std::min(to.worst_side, static_cast<double>(colored) / kAlong);
  }
  to.bar_share = median(widths) / to.side_px;
  to.cb_step = median(cb), to.cr_step = median(cr), to.cr_minus_cb = median(excess);
}

/// Mean width of the strong edges across columns: the step from end to end over its steepest part.
template <class Level>
double edge_width(const Image& image, double strong, const Level& level) {
  double sum = 0.0;
  int count = 0;
  for (int v = 2; v + 2 < image.height(); v += 2)
    for (int u = 4; u + 4 < image.width(); ++u) {
      const auto step = [&](int k) {
        return level(image.at(u + k + 1, v)) - level(image.at(u + k, v));
      };
      const double here = step(0);
      if (std::abs(here) < strong || std::abs(here) < std::abs(step(-1)) ||
          std::abs(here) < std::abs(step(1)))
        continue;
      double whole = here;
      for (const int way : {-1, 1})
        for (int k = way; std::abs(k) <= 3 && step(k) * here > 0.0; k += way) whole += step(k);
      sum += whole / here, ++count;
    }
  return count > 0 ? sum / count : std::nan("");
}

}  // namespace

GateAppearance appearance_of(const TwinPicture& picture) {
  GateAppearance a;
  const Image image = picture.view();
  a.luma_edge_px = edge_width(image, kStrongY, [](Yuv c) { return static_cast<double>(c.y); });
  a.chroma_edge_px = edge_width(image, kStrongCr, [](Yuv c) { return static_cast<double>(c.v); });
  int edges = 0;
  for (int v = 1; v < image.height(); ++v)
    for (int u = 1; u < image.width(); ++u) {
      const int y = image.at(u, v).y;
      edges += std::max(std::abs(y - image.at(u - 1, v).y), std::abs(y - image.at(u, v - 1).y)) >
               kStrongY;
    }
  a.edges = static_cast<double>(edges) / (image.width() * image.height());
  if (!picture.gate) return a;
  const Quad gate = files::polygon(*picture.gate);
  a.side_px = std::sqrt(files::polygon_area(gate));
  double wide = 0.0, high = 0.0;
  for (std::size_t s = 0; s < 4; ++s) {
    const Eigen::Vector2d along = gate[(s + 1) % 4] - gate[s];
    (std::abs(along.x()) > std::abs(along.y()) ? wide : high) += along.norm();
  }
  a.aspect = high > 0.0 ? wide / high : std::nan("");
  look_along_bars(image, gate, a);
  return a;
}

std::span<const Feature> features() {
  using A = GateAppearance;
  static constexpr std::array kFeatures{
      Feature{"aspect", "gate's width / height", &A::aspect},
      Feature{"bar_share", "bar / side", &A::bar_share},
      Feature{"cb_step", "Cb, bar minus beside", &A::cb_step},
      Feature{"cr_step", "Cr, bar minus beside", &A::cr_step},
      Feature{"cr_minus_cb", "Cr - Cb on the bar", &A::cr_minus_cb},
      Feature{"uneven", "its spread along a side", &A::uneven},
      Feature{"worst_side", "coloured part of the worst side", &A::worst_side},
      Feature{"luma_edge_px", "width of luma edges [px]", &A::luma_edge_px},
      Feature{"chroma_edge_px", "width of chroma edges [px]", &A::chroma_edge_px},
      Feature{"edges", "pixels on luma edges", &A::edges}};
  return kFeatures;
}

}  // namespace gatefly::experiments
