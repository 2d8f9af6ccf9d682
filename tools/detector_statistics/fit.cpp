// SPDX-License-Identifier: Apache-2.0
#include "fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "gatefly/files/quantile.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/normal.hpp"

namespace gatefly::measuring {
namespace {

constexpr double kPeriod = 1.0 / 15.0;  // from picture to picture [s]
constexpr int kFew = 20;                // hits or misses: too few to say how they come in rows
constexpr std::array<int, 6> kLags{1, 2, 3, 5, 8, 14};

/// P(X < h, Y < k) of two standard normal numbers with correlation r. [Drezner 1978, by Simpson]
double both_below(double h, double k, double r) {
  constexpr int kSteps = 40;
  const double end = std::asin(r), step = end / kSteps;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double theta = i * step, c = std::cos(theta);
    const double f = std::exp(-(h * h + k * k - 2 * h * k * std::sin(theta)) / (2 * c * c));
    sum += (i == 0 || i == kSteps ? 1.0 : i % 2 ? 4.0 : 2.0) * f;
  }
  return sim::normal_cdf(h) * sim::normal_cdf(k) + sum * step / 3.0 / (2 * kPi);
}

/// Pairs of looks: how many hit both, the first only, the second only, none; by the bins of both.
struct Pairs {
  std::array<std::array<std::array<double, 4>, kSizes.size()>, kSizes.size()> count{};

  void add(std::size_t a, bool hit_a, std::size_t b, bool hit_b, double weight = 1.0) {
    count[a][b][(hit_a ? 0u : 2u) + (hit_b ? 0u : 1u)] += weight;
  }
};

/// The correlation that makes these pairs most probable.
std::optional<double> most_probable(const Pairs& pairs,
                                    const std::array<double, kSizes.size()>& thresholds) {
  std::array<double, 4> sums{};
  for (const auto& row : pairs.count)
    for (const auto& cell : row)
      for (std::size_t i = 0; i < 4; ++i) sums[i] += cell[i];
  if (sums[0] + sums[1] < kFew || sums[2] + sums[3] < kFew) return std::nullopt;
  double best = -1e300, best_r = 0.0;
  for (double r = -0.2; r < 0.995; r += 0.02) {
    double likelihood = 0.0;
    for (std::size_t a = 0; a < kSizes.size(); ++a)
      for (std::size_t b = 0; b < kSizes.size(); ++b) {
        const auto& n = pairs.count[a][b];
        if (n[0] + n[1] + n[2] + n[3] == 0.0) continue;
        const double both = both_below(thresholds[a], thresholds[b], r),
                     first = sim::normal_cdf(thresholds[a]),
                     second = sim::normal_cdf(thresholds[b]);
        const std::array<double, 4> p{both, first - both, second - both,
                                      1.0 - first - second + both};
        for (std::size_t i = 0; i < 4; ++i) likelihood += n[i] * std::log(std::max(p[i], 1e-9));
      }
    if (likelihood > best) best = likelihood, best_r = r;
  }
  return best_r;
}

std::array<double, kSizes.size()> thresholds_of(const std::vector<Look>& looks) {
  std::array<double, kSizes.size()> thresholds{};
  for (std::size_t bin = 0; bin < kSizes.size(); ++bin) {
    const auto there = in_bin(looks, bin);
    const double n = static_cast<double>(there.size());
    // half a look of either kind more: none is certain
    thresholds[bin] = sim::normal_quantile((rate_of(there) * n + 0.5) / (n + 1.0));
  }
  return thresholds;
}

struct Point {
  double lag = 0.0;  ///< [s]
  double correlation = 0.0;
};

/// The curve seed + row exp(-lag / time) nearest to the points; `seed` given or looked for.
sim::Staying nearest_curve(const std::vector<Point>& points, std::optional<double> seed) {
  sim::Staying best;
  double least = 1e300;
  for (double s = seed.value_or(0.0); s <= seed.value_or(0.9); s += 0.02) {
    for (double row = 0.0; s + row <= 0.981; row += 0.02)
      for (double time = 0.05; time < 5.0; time *= 1.15) {
        double off = 0.0;
        for (const Point& p : points) {
          const double model = s + row * std::exp(-p.lag / time);
          off += (p.correlation - model) * (p.correlation - model);
        }
        if (off < least) least = off, best = {s, row, time};
      }
    if (seed) break;
  }
  return best;
}

/// Median and 1.4826 times the median distance from it.
std::pair<double, double> robust(const std::vector<double>& values) {
  if (values.empty()) return {0.0, 0.0};
  const double middle = files::nearest_rank(values, 0.5);
  std::vector<double> off;
  for (const double v : values) off.push_back(std::abs(v - middle));
  return {middle, 1.4826 * files::nearest_rank(off, 0.5)};
}

double middle_of_four(std::array<double, 4> v) {
  std::sort(v.begin(), v.end());
  return 0.5 * (v[1] + v[2]);
}

/// A hit's errors, taken apart.
struct Apart {
  const Look* look = nullptr;
  Eigen::Vector2d together{0, 0};
  double size = 0.0;
  std::array<Eigen::Vector2d, 4> own;
};

Apart apart(const Look& look) {
  std::array<Eigen::Vector2d, 4> error, out;
  const Eigen::Vector2d middle = center(look.truth);
  Apart result{.look = &look, .own = {}};
  for (std::size_t i = 0; i < 4; ++i) {
    error[i] = look.seen[i] - look.truth[i];
    out[i] = (look.truth[i] - middle).normalized();
  }
  for (int axis = 0; axis < 2; ++axis)
    result.together[axis] =
        middle_of_four({error[0][axis], error[1][axis], error[2][axis], error[3][axis]});
  const auto growth = [&](std::size_t i) { return (error[i] - result.together).dot(out[i]); };
  result.size = middle_of_four({growth(0), growth(1), growth(2), growth(3)});
  for (std::size_t i = 0; i < 4; ++i)
    result.own[i] = error[i] - result.together - result.size * out[i];
  return result;
}

/// Correlation of the part that all corners share, `lag` pictures apart.
double correlation_of_errors(const std::vector<Apart>& hits, double sigma, int lag) {
  std::map<std::tuple<int, int, int>, const Apart*> by_place;
  for (const Apart& hit : hits)
    by_place[{hit.look->window, hit.look->which, hit.look->step}] = &hit;
  const auto cut = [&](double e) { return std::clamp(e, -3 * sigma, 3 * sigma); };
  double product = 0.0, square = 0.0;
  for (const Apart& hit : hits) {
    const auto later = by_place.find({hit.look->window, hit.look->which, hit.look->step + lag});
    if (later == by_place.end()) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const double a = cut(hit.together[axis]), b = cut(later->second->together[axis]);
      product += a * b, square += 0.5 * (a * a + b * b);
    }
  }
  return square > 0.0 ? product / square : 0.0;
}

}  // namespace

std::size_t bin_of(double side_px) {
  std::size_t bin = 0;
  while (bin + 1 < kSizes.size() && side_px >= kSizes[bin]) ++bin;
  return bin;
}

double rate_of(const std::vector<Look>& looks) {
  if (looks.empty()) return 0.0;
  return static_cast<double>(
             std::count_if(looks.begin(), looks.end(), [](const Look& l) { return l.hit; })) /
         static_cast<double>(looks.size());
}

std::vector<Look> in_bin(const std::vector<Look>& looks, std::size_t bin) {
  std::vector<Look> there;
  for (const Look& look : looks)
    if (bin_of(look.side_px) == bin) there.push_back(look);
  return there;
}

std::optional<double> correlation(const std::vector<Look>& looks, int lag) {
  std::map<std::tuple<int, int, int>, const Look*> by_place;
  for (const Look& look : looks) by_place[{look.window, look.which, look.step}] = &look;
  Pairs pairs;
  for (const Look& look : looks) {
    const auto later = by_place.find({look.window, look.which, look.step + lag});
    if (later != by_place.end())
      pairs.add(bin_of(look.side_px), look.hit, bin_of(later->second->side_px), later->second->hit);
  }
  return most_probable(pairs, thresholds_of(looks));
}

std::optional<double> correlation_of_seeds(const std::vector<Look>& looks, Share share) {
  // hits and misses by (seed, thing), window, bin
  using Counts = std::array<std::array<double, 2>, kSizes.size()>;
  std::map<std::pair<int, int>, std::map<int, Counts>> counts;
  for (const Look& look : looks)
    ++counts[{look.seed, share == Share::kAll ? 0 : look.which}][look.window][bin_of(look.side_px)]
            [look.hit ? 0 : 1];
  Pairs pairs;
  for (const auto& [key, windows] : counts)
    for (const auto& [w1, a] : windows)
      for (const auto& [w2, b] : windows)
        for (std::size_t i = 0; w1 < w2 && i < kSizes.size(); ++i)
          for (std::size_t j = 0; j < kSizes.size(); ++j)
            for (const bool hit_a : {true, false})
              for (const bool hit_b : {true, false})
                pairs.add(i, hit_a, j, hit_b, a[i][hit_a ? 0 : 1] * b[j][hit_b ? 0 : 1]);
  return most_probable(pairs, thresholds_of(looks));
}

sim::Staying staying_of(const std::vector<Look>& looks, Share share) {
  std::vector<Point> points;
  for (const int lag : kLags)
    if (const auto r = correlation(looks, lag)) points.push_back({lag * kPeriod, *r});
  if (points.size() < 3) return {0.0, 0.7, 0.2};  // too few: about what the others have
  const auto of_seeds = correlation_of_seeds(looks, share);
  return nearest_curve(points, std::clamp(of_seeds.value_or(0.0), 0.0, 0.9));
}

sim::Staying staying_of(const std::vector<Alarm>& alarms, double rate) {
  constexpr sim::Staying kLamps{0.5, 0.45, 0.5};  // too few to tell: they stay where they are
  if (static_cast<int>(alarms.size()) < kFew || rate <= 0.0) return kLamps;
  const double threshold = sim::normal_quantile(rate);
  std::vector<Point> points;
  for (std::size_t lag = 1; lag <= std::tuple_size_v<decltype(Alarm::again)>; ++lag) {
    double asked = 0.0, again = 0.0;
    for (const Alarm& alarm : alarms)
      asked += alarm.in_view[lag - 1], again += alarm.again[lag - 1];
    if (asked < kFew) break;
    double r = 0.0;
    while (r < 0.98 && both_below(threshold, threshold, r) < rate * again / asked) r += 0.01;
    points.push_back({static_cast<double>(lag) * kPeriod, r});
  }
  return points.size() < 3 ? kLamps : nearest_curve(points, std::nullopt);
}

sim::Quantiles quantiles_of(std::vector<double> values) {
  sim::Quantiles result{};
  std::sort(values.begin(), values.end());
  if (values.empty()) return result;
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = files::quantile(values, static_cast<double>(i) / (result.size() - 1));
  return result;
}

std::vector<double> fitness_of(const std::vector<Look>& looks) {
  std::vector<double> values;
  for (const Look& look : looks)
    if (look.hit) values.push_back(look.fitness);
  return values;
}

sim::CornerErrors corner_errors_of(const std::vector<Look>& looks) {
  std::vector<Apart> hits;
  std::vector<double> together, size, own;
  for (const Look& look : looks) {
    if (!look.hit) continue;
    hits.push_back(apart(look));
    const Apart& hit = hits.back();
    size.push_back(hit.size);
    for (int axis = 0; axis < 2; ++axis) {
      together.push_back(hit.together[axis]);
      for (const Eigen::Vector2d& corner : hit.own) own.push_back(corner[axis]);
    }
  }
  sim::CornerErrors errors{
      .together = robust(together).second, .size = robust(size).second, .own = robust(own).second};
  if (hits.empty()) return errors;
  const double limit = std::max(3.0, 5.0 * errors.own);
  std::vector<double> beyond;
  for (const Apart& hit : hits)
    for (const Eigen::Vector2d& corner : hit.own)
      if (corner.norm() > limit) beyond.push_back(corner.norm());
  errors.outlier_rate =
      static_cast<double>(beyond.size()) / (4.0 * static_cast<double>(hits.size()));
  std::sort(beyond.begin(), beyond.end());
  errors.outlier_low = limit, errors.outlier_high = limit;
  if (!beyond.empty()) errors.outlier_high = files::quantile(beyond, 0.9);
  std::vector<Point> points;
  for (const int lag : kLags)
    points.push_back({lag * kPeriod, correlation_of_errors(hits, errors.together, lag)});
  const sim::Staying curve = nearest_curve(points, 0.0);
  errors.stays = curve.row, errors.time = curve.time;
  return errors;
}

}  // namespace gatefly::measuring
