// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/scoring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <polyclipping/clipper.hpp>

namespace gatefly::files {
namespace {

constexpr double kNoRate = std::numeric_limits<double>::quiet_NaN();

bool cross_each_other(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                      const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 &&
         cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

double intersection_over_union(const Quad& a, const Quad& b) {
  const double shared = polygon_shared_area(a, b);
  const double together = polygon_area(a) + polygon_area(b) - shared;
  return together > 0.0 ? shared / together : 0.0;
}

bool matches_any(const Quad& quad, std::span<const Quad> others, Rule rule) {
  return std::any_of(others.begin(), others.end(),
                     [&](const Quad& other) { return matches(quad, other, rule); });
}

/// A detection and a gate that match.
struct Match {
  std::size_t detection, gate;
  double overlap;
};

/// At most one detection per gate and one gate per detection, the largest overlap first.
std::vector<Match> hits_of(const PictureToScore& picture, Rule rule) {
  std::vector<Match> candidates, hits;
  for (std::size_t d = 0; d < picture.detections.size(); ++d)
    for (std::size_t g = 0; g < picture.gates.size(); ++g)
      if (matches(picture.detections[d], picture.gates[g], rule))
        candidates.push_back(
            {d, g, intersection_over_union(picture.detections[d], picture.gates[g])});
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Match& a, const Match& b) { return a.overlap > b.overlap; });
  for (const Match& candidate : candidates)
    if (std::none_of(hits.begin(), hits.end(), [&](const Match& hit) {
          return hit.detection == candidate.detection || hit.gate == candidate.gate;
        }))
      hits.push_back(candidate);
  return hits;
}

void count(std::vector<HitRate>& rates, double value, bool hit) {
  for (HitRate& rate : rates)
    if (value >= rate.from && value < rate.to) ++rate.gates, rate.hits += hit;
}

std::vector<HitRate> size_rates() {
  std::vector<HitRate> rates;
  const std::array<double, 6> edges{0, 20, 30, 45, 70, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    rates.push_back({.from = edges[i], .to = edges[i + 1]});
  return rates;
}

/// One for each metre that occurs: "6 m" is 5.5 to 6.5.
std::vector<HitRate> distance_rates(std::span<const PictureToScore> pictures) {
  std::set<double> metres;
  for (const auto& picture : pictures)
    if (!picture.gates.empty() && std::isfinite(picture.true_distance))
      metres.insert(std::round(picture.true_distance));
  std::vector<HitRate> rates;
  for (const double metre : metres) rates.push_back({.from = metre - 0.5, .to = metre + 0.5});
  return rates;
}

void add(Score& total, const PictureToScore& picture, Rule rule) {
  const std::vector<Match> hits = hits_of(picture, rule);
  std::vector<bool> gate_hit(picture.gates.size()), detection_hit(picture.detections.size());
  for (const Match& hit : hits) {
    gate_hit[hit.gate] = detection_hit[hit.detection] = true;
    const CornerErrors errors =
        corner_errors(picture.detections[hit.detection], picture.gates[hit.gate]);
    total.best_order_px.insert(total.best_order_px.end(), errors.best_order.begin(),
                               errors.best_order.end());
    total.as_listed_px.insert(total.as_listed_px.end(), errors.as_listed.begin(),
                              errors.as_listed.end());
  }
  for (std::size_t g = 0; g < picture.gates.size(); ++g) {
    count(total.by_size, std::sqrt(polygon_area(picture.gates[g])), gate_hit[g]);
    count(total.by_distance, picture.true_distance, gate_hit[g]);
  }
  for (std::size_t d = 0; d < picture.detections.size(); ++d) {
    if (detection_hit[d]) continue;
    const bool forgiven =
        rule == Rule::kOverlap70Authors && matches_any(picture.detections[d], picture.gates, rule);
    if (forgiven || matches_any(picture.detections[d], picture.ignored, rule))
      ++total.neither;
    else
      ++total.false_positives;
  }
  ++total.pictures;
  total.gates += static_cast<int>(picture.gates.size());
  total.detections += static_cast<int>(picture.detections.size());
  total.hits += static_cast<int>(hits.size());
}

}  // namespace

Rule rule_of(const std::string& name) {
  if (name == "overlap70") return Rule::kOverlap70;
  if (name == "overlap70-authors") return Rule::kOverlap70Authors;
  if (name == "iou50") return Rule::kIou50;
  if (name == "iou75") return Rule::kIou75;
  throw std::invalid_argument("no rule '" + name + "'");
}

Quad polygon(const Quad& quad) {
  // Sides that cross are the diagonals of a convex polygon.
  Quad p = quad;
  if (cross_each_other(p[0], p[1], p[2], p[3]))
    std::swap(p[1], p[2]);
  else if (cross_each_other(p[1], p[2], p[3], p[0]))
    std::swap(p[2], p[3]);
  if (area(p) < 0) std::swap(p[1], p[3]);
  return p;
}

double polygon_area(const Quad& quad) { return std::abs(area(polygon(quad))); }

double polygon_shared_area(const Quad& a, const Quad& b) {
  // Clipper counts in whole numbers: a pixel is 2^20 of them, so that a corner of 10^12 px fits.
  static constexpr double kUnits = 1048576.0, kMostPx = 1e12;
  const auto path_of = [](const Quad& quad) {
    ClipperLib::Path path;
    for (const Eigen::Vector2d& corner : polygon(quad)) {
      const auto whole = [](double px) {
        return std::llround(kUnits * std::clamp(px, -kMostPx, kMostPx));
      };
      path.emplace_back(whole(corner.x()), whole(corner.y()));
    }
    return path;
  };
  ClipperLib::Clipper clipper;
  ClipperLib::Paths shared;
  clipper.AddPath(path_of(a), ClipperLib::ptSubject, true);
  clipper.AddPath(path_of(b), ClipperLib::ptClip, true);
  clipper.Execute(ClipperLib::ctIntersection, shared, ClipperLib::pftNonZero,
                  ClipperLib::pftNonZero);
  double area = 0.0;
  for (const ClipperLib::Path& path : shared) area += ClipperLib::Area(path);
  return std::abs(area) / (kUnits * kUnits);
}

bool matches(const Quad& a, const Quad& b, Rule rule) {
  switch (rule) {
    case Rule::kIou50:
      return intersection_over_union(a, b) >= 0.5;
    case Rule::kIou75:
      return intersection_over_union(a, b) >= 0.75;
    case Rule::kOverlap70:
    case Rule::kOverlap70Authors:
      break;
  }
  const double larger = std::max(polygon_area(a), polygon_area(b));
  return larger > 0.0 && polygon_shared_area(a, b) >= 0.7 * larger;
}

CornerErrors corner_errors(const Quad& detection, const Quad& label) {
  CornerErrors errors{};
  for (std::size_t i = 0; i < 4; ++i) errors.as_listed[i] = (detection[i] - label[i]).norm();

  // Both run clockwise now, whichever way they were listed.
  const Quad found = polygon(detection), wanted = polygon(label);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t shift = 0; shift < 4; ++shift) {
    std::array<double, 4> distances{};
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      distances[i] = (found[(shift + i) % 4] - wanted[i]).norm();
      sum += distances[i] * distances[i];
    }
    if (sum < least) least = sum, errors.best_order = distances;
  }
  return errors;
}

double Score::true_positive_rate() const {
  return gates > 0 ? static_cast<double>(hits) / gates : kNoRate;
}

double Score::false_positives_per_image() const {
  return pictures > 0 ? static_cast<double>(false_positives) / pictures : kNoRate;
}

Score score(std::span<const PictureToScore> pictures, Rule rule, bool nearest) {
  Score total;
  total.by_size = size_rates();
  total.by_distance = distance_rates(pictures);
  for (PictureToScore picture : pictures) {
    if (nearest && picture.gates.size() > 1) {
      picture.ignored.insert(picture.ignored.end(), picture.gates.begin() + 1, picture.gates.end());
      picture.gates.resize(1);
    }
    add(total, picture, rule);
  }
  std::sort(total.best_order_px.begin(), total.best_order_px.end());
  std::sort(total.as_listed_px.begin(), total.as_listed_px.end());
  return total;
}

ScoreInput brought_together(const Labels& labels, std::span<const DetectionRow> detections,
                            const Labels& ignored, Rule rule) {
  ScoreInput input;
  input.degenerate = static_cast<int>(labels.degenerate.size());
  constexpr std::size_t kLeftOut = std::numeric_limits<std::size_t>::max();
  std::map<std::string, std::size_t> place_of;
  for (const std::string& image : labels.degenerate) place_of[image] = kLeftOut;

  std::set<std::string> seen;  // one name for each group of identical pictures
  for (const LabelledPicture& picture : labels.pictures) {
    const bool first =
        seen.insert(picture.first_identical.empty() ? picture.image : picture.first_identical)
            .second;
    if (!first && rule != Rule::kOverlap70Authors) {
      place_of[picture.image] = kLeftOut;
      ++input.duplicates;
      continue;
    }
    place_of[picture.image] = input.pictures.size();
    input.pictures.push_back({.gates = picture.gates,
                              .ignored = {},
                              .detections = {},
                              .true_distance = picture.true_distance});
  }
  for (const LabelledPicture& picture : ignored.pictures) {
    const auto found = place_of.find(picture.image);
    if (found == place_of.end() || found->second == kLeftOut) continue;
    auto& quads = input.pictures[found->second].ignored;
    quads.insert(quads.end(), picture.gates.begin(), picture.gates.end());
  }
  for (const DetectionRow& row : detections) {
    const auto found = place_of.find(row.image);
    if (found == place_of.end())
      input.unknown.push_back(row.image);
    else if (found->second == kLeftOut)
      continue;
    else if (row.method == "bars")
      ++input.bars;
    else
      input.pictures[found->second].detections.push_back(row.corners_px);
  }
  return input;
}

}  // namespace gatefly::files
