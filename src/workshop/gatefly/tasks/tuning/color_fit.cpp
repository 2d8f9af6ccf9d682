// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/color_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/pixel_evidence.hpp"

namespace gatefly::tuning {
namespace {

constexpr std::array kSizes{ColorModel::kLuma, ColorModel::kChroma, ColorModel::kChroma};
constexpr double kMostNats = 4.0, kStep = 0.125;  // as a file keeps them
using Histogram = std::vector<double>;

/// Pixels by colour and by difference from what is around them.
struct Counts {
  Histogram absolute = Histogram(ColorModel::kBins), relative = Histogram(ColorModel::kBins);

  void add(const PictureColor& picture, Yuv color, Yuv around, double weight) {
    absolute[picture.bin(color)] += weight;
    relative[picture.difference_bin(color, around)] += weight;
  }
};

// A bell over neighbouring bins, axis by axis; what would fall off an end stays in the last bin.
void smooth(Histogram& histogram, const std::array<double, 3>& sigma) {
  std::size_t stride = histogram.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    stride /= kSizes[axis];
    std::array<double, 7> bell{};
    double sum = 0.0;
    for (int k = -3; k <= 3; ++k)
      sum += bell[static_cast<std::size_t>(k + 3)] =
          std::exp(-0.5 * k * k / (sigma[axis] * sigma[axis]));
    Histogram out(histogram.size());
    for (std::size_t i = 0; i < histogram.size(); ++i) {
      if (histogram[i] == 0.0) continue;
      const int at = static_cast<int>(i / stride % kSizes[axis]);
      for (int k = -3; k <= 3; ++k) {
        const int to = std::clamp(at + k, 0, static_cast<int>(kSizes[axis]) - 1);
        const auto j = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) +
                                                (to - at) * static_cast<std::ptrdiff_t>(stride));
        out[j] += bell[static_cast<std::size_t>(k + 3)] / sum * histogram[i];
      }
    }
    histogram = std::move(out);
  }
}

/// The middle lines of a gate's bars, where they bend in pieces.
std::vector<Eigen::Vector2d> outline_of(const Quad& q, const SideCurves& curves) {
  const int pieces = curves.bent() ? 8 : 1;
  std::vector<Eigen::Vector2d> outline;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = q[i], &b = q[(i + 1) % 4], sag = curves.sag(a, b);
    outline.push_back(a);
    for (int k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      outline.push_back(a + t * (b - a) + 4.0 * t * (1.0 - t) * sag);
    }
  }
  return outline;
}

double distance_to_bars(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  double nearest = 1e18;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d a = outline[i], d = outline[(i + 1) % outline.size()] - a;
    const double t = std::clamp((p - a).dot(d) / std::max(1e-9, d.squaredNorm()), 0.0, 1.0);
    nearest = std::min(nearest, (p - a - t * d).squaredNorm());
  }
  return std::sqrt(nearest);
}

double size_of(const Quad& q) { return std::sqrt(std::abs(area(q))); }

/// Columns of a row, both included.
struct Stretch {
  int from, to;
};

/// Part of a row within `reach` of a side; from > to: nowhere.
Stretch stretch_near(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int v, double reach,
                     int width) {
  const Eigen::Vector2d d = b - a;
  double first = 0.0, last = 1.0;  // part of the side that is near enough to the row
  if (std::abs(d.y()) > 1e-9) {
    const double s = (v - reach - a.y()) / d.y(), t = (v + reach - a.y()) / d.y();
    first = std::max(first, std::min(s, t)), last = std::min(last, std::max(s, t));
  } else if (std::abs(v - a.y()) > reach) {
    return {1, 0};
  }
  if (!(first <= last)) return {1, 0};
  const auto [low, high] = std::minmax({a.x() + first * d.x(), a.x() + last * d.x()});
  const auto column = [&](double x) {
    return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(width)));
  };
  return {std::max(0, column(std::floor(low - reach - 1.0))),
          std::min(width - 1, column(std::ceil(high + reach + 1.0)))};
}

/// Calls visit(u, v) for all pixels of a picture within `reach` of a quad's sides, row by row. Of a
/// large quad most rows are opening: only what is beside a side is looked at.
template <class Visit>
void near_bars(const Image& image, const Quad& q, const LensBend& bend, double reach, Visit visit) {
  const std::vector<Eigen::Vector2d> outline = outline_of(q, {bend, image});
  double low = q[0].y(), high = q[0].y();
  for (const auto& p : outline) low = std::min(low, p.y()), high = std::max(high, p.y());
  const auto row = [&](double y) {
    return static_cast<int>(std::clamp(y, -1.0, static_cast<double>(image.height())));
  };
  const int last = std::min(image.height() - 1, row(std::ceil(high + reach)));
  std::vector<Stretch> near;
  for (int v = std::max(0, row(std::floor(low - reach))); v <= last; ++v) {
    near.clear();
    for (std::size_t i = 0; i < outline.size(); ++i)
      near.push_back(
          stretch_near(outline[i], outline[(i + 1) % outline.size()], v, reach, image.width()));
    std::sort(near.begin(), near.end(),
              [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
    int u = 0;
    for (const Stretch& each : near)
      for (u = std::max(u, each.from); u <= each.to; ++u)
        if (distance_to_bars(outline, {u, v}) <= reach) visit(u, v);
  }
}

Counts background_of(std::span<const ColorPicture> pictures, PixelEvidence& evidence,
                     const LensBend& bend, const ColorFitParams& params) {
  static const ColorModel kNoColor;
  Counts counts;
  std::vector<std::uint8_t> is_near;
  for (const ColorPicture& picture : pictures) {
    const Image& image = picture.image;
    evidence.read(image, kNoColor);
    if (evidence.empty()) continue;
    is_near.assign(
        static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()), 0);
    const auto at = [&](int u, int v) {
      return static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width()) +
             static_cast<std::size_t>(u);
    };
    const auto leave_out = [&](const Quad& q) {
      near_bars(image, q, bend, 6.0 + 1.2 * params.bar_ratio * size_of(q),
                [&](int u, int v) { is_near[at(u, v)] = 1; });
    };
    for (const Example& gate : picture.gates) leave_out(gate.bars_px);
    for (const Quad& q : picture.unsure) leave_out(q);
    for (int v = 0; v < image.height(); ++v)
      for (int u = 0; u < image.width(); ++u)
        if (is_near[at(u, v)] == 0)
          counts.add(evidence.color(), image.at(u, v), evidence.around(u, v), 1.0);
  }
  for (Histogram* histogram : {&counts.absolute, &counts.relative})
    smooth(*histogram, {0.6, 0.72, 0.72});
  return counts;
}

/// Every gate counts the same whatever its size; a pixel by the chance that it is a bar's.
Counts gates_of(std::span<const ColorPicture> pictures, const ColorModel& model, bool first,
                PixelEvidence& evidence, const LensBend& bend, const ColorFitParams& params) {
  Counts counts;
  for (const ColorPicture& picture : pictures) {
    if (picture.gates.empty()) continue;
    evidence.read(picture.image, model);
    if (evidence.empty()) continue;
    for (const Example& gate : picture.gates) {
      const double size = std::max(1.0, size_of(gate.bars_px)),
                   half_bar = 0.45 * params.bar_ratio * size;
      // Before the first pull the sides are off by some pixels.
      const double reach = half_bar + (first ? 2.0 : 0.7), all = 8.0 * reach * size;
      near_bars(picture.image, gate.bars_px, bend, reach, [&](int u, int v) {
        const double nats = evidence.at(u, v) / static_cast<double>(ColorModel::kUnit);
        const double chance = first ? 1.0 : 1.0 / (1.0 + std::exp(-nats));
        counts.add(evidence.color(), picture.image.at(u, v), evidence.around(u, v),
                   gate.weight * chance / all);
      });
    }
  }
  for (Histogram* histogram : {&counts.absolute, &counts.relative})
    smooth(*histogram, {1.0, 1.2, 1.2});
  return counts;
}

double sum_of(const Histogram& histogram) {
  double sum = 0.0;
  for (const double x : histogram) sum += x;
  return sum;
}

// Posterior mean of the bars' share of each bin against the background's. The prior is a share,
// too: the background's, and a little of everything, times what the prior's table says.
void set_table(std::array<std::int8_t, ColorModel::kBins>& table,
               const std::array<std::int8_t, ColorModel::kBins>& prior, const Histogram& gates,
               const Histogram& background, double gates_total, double prior_gates) {
  // of the background is any colour: one that was never seen is not impossible
  constexpr double kAnything = 0.03;
  const double pixels = std::max(1.0, sum_of(background)), seen = std::max(1e-9, sum_of(gates));
  Histogram share(ColorModel::kBins), believed(ColorModel::kBins);
  for (std::size_t i = 0; i < ColorModel::kBins; ++i) {
    share[i] = (1.0 - kAnything) * background[i] / pixels +
               kAnything / static_cast<double>(ColorModel::kBins);
    believed[i] = share[i] * std::exp(prior[i] / static_cast<double>(ColorModel::kUnit));
  }
  const double all = sum_of(believed), weight = gates_total / (gates_total + prior_gates);
  for (std::size_t i = 0; i < ColorModel::kBins; ++i) {
    const double bars = weight * gates[i] / seen + (1.0 - weight) * believed[i] / all;
    const double nats = std::clamp(std::log(bars / share[i]), -kMostNats, kMostNats - kStep);
    table[i] = static_cast<std::int8_t>(std::lround(nats / kStep) *
                                        std::lround(ColorModel::kUnit * kStep));
  }
}

}  // namespace

ColorModel fit_colors(std::span<const ColorPicture> given, const ColorModel& prior,
                      const ColorFitParams& params) {
  std::vector<ColorPicture> pictures(given.begin(), given.end());
  double total = 0.0;
  for (ColorPicture& picture : pictures)
    for (Example& gate : picture.gates)
      gate.bars_px = clockwise_from_top_left(gate.bars_px), total += gate.weight;
  PixelEvidence evidence;
  const LensBend bend{params.lens};
  const Counts background = background_of(pictures, evidence, bend, params);
  ColorModel model = prior;
  for (int round = 0; round < params.rounds; ++round) {
    const Counts gates = gates_of(pictures, model, round == 0, evidence, bend, params);
    set_table(model.absolute, prior.absolute, gates.absolute, background.absolute, total,
              params.prior_gates);
    set_table(model.relative, prior.relative, gates.relative, background.relative, total,
              params.prior_gates);
    if (round + 1 == params.rounds) break;
    for (std::size_t p = 0; p < pictures.size(); ++p) {
      if (pictures[p].gates.empty()) continue;
      evidence.read(pictures[p].image, model);
      // from where it was given: no drift
      for (std::size_t g = 0; g < pictures[p].gates.size(); ++g)
        pictures[p].gates[g].bars_px =
            evidence.pulled(clockwise_from_top_left(given[p].gates[g].bars_px),
                            params.bar_ratio / (1.0 - params.bar_ratio), {bend, pictures[p].image});
    }
  }
  model.find_hopeless();
  return model;
}

}  // namespace gatefly::tuning
