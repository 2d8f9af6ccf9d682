// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/ideal_vision.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

// nearer than this the upper bar may be cut off: race/sight.cpp [m]
constexpr double kLowerCornersReach = 3.5;
constexpr double kBarsReach = 1.8;  // [Li18 flight code]
// a false pair of bars or lower corners: at least so far apart [Li18 flight code] [px]
constexpr double kLeastGap = 40.0;

double at(const Quantiles& quantiles, double part) {
  const double x = std::clamp(part, 0.0, 1.0) * static_cast<double>(quantiles.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(x), quantiles.size() - 2);
  return quantiles[i] + (x - static_cast<double>(i)) * (quantiles[i + 1] - quantiles[i]);
}

double side_of(const std::array<Eigen::Vector2d, 4>& quad) {
  const Eigen::Vector2d a = quad[2] - quad[0], b = quad[3] - quad[1];
  return std::sqrt(0.5 * std::abs(a.x() * b.y() - a.y() * b.x()));
}

const SizeBin& bin_of(const std::array<SizeBin, 5>& bins, double side_px) {
  for (const SizeBin& bin : bins)
    if (side_px < bin.below_px) return bin;
  return bins.back();
}

const CutBin& cut_bin_of(const CutBins& bins, double side_px) {
  for (const CutBin& bin : bins)
    if (side_px < bin.below_px) return bin;
  return bins.back();
}

DetectorStatistics with_false_alarms(DetectorStatistics statistics, double factor) {
  for (Finds* each :
       {&statistics.crooked, &statistics.two_gates, &statistics.decoys, &statistics.places})
    each->rate *= factor;
  statistics.lower.false_rate *= factor, statistics.bars.false_rate *= factor;
  statistics.cuts.false_rate *= factor;
  return statistics;
}

}  // namespace

IdealVision::IdealVision(const world::World& world, const world::CameraTruth& camera,
                         const world::IdealVisionParams& params, std::uint64_t seed,
                         const Sight& sight)
    : world_{world},
      camera_{camera},
      build_{build_of(world.gates)},
      statistics_{with_false_alarms(statistics_of(params.detector, build_), params.false_alarms)},
      one_answer_{params.detector == "paper"},
      outliers_{params.outliers},
      sight_{sight},
      seed_{seed},
      places_{places_of(world, seed)},
      gates_{seed, "ideal gate", statistics_.staying, true},
      aslant_{seed, "ideal aslant", statistics_.aslant.staying, false},
      hidden_{seed, "ideal hidden", statistics_.hidden.staying, false},
      crooked_{seed, "ideal crooked", statistics_.crooked.staying, false},
      two_gates_{seed, "ideal two gates", statistics_.two_gates.staying, false},
      decoys_{seed, "ideal decoy", statistics_.decoys.staying, false},
      at_places_{seed, "ideal place", statistics_.places.staying, false},
      lower_{seed, "ideal lower", statistics_.lower.staying, true},
      bars_{seed, "ideal bars", statistics_.bars.staying, true},
      cut_{seed, "ideal cut", statistics_.cuts.staying, true},
      right_{seed, "ideal right", {0.0, statistics_.corners.stays, statistics_.corners.time}, true},
      down_{seed, "ideal down", {0.0, statistics_.corners.stays, statistics_.corners.time}, true},
      size_{seed, "ideal size", {0.0, statistics_.corners.stays, statistics_.corners.time}, true},
      false_lower_{"ideal false lower where",
                   {seed, "ideal false lower", statistics_.lower.false_staying, false},
                   {}},
      false_bars_{"ideal false bars where",
                  {seed, "ideal false bars", statistics_.bars.false_staying, false},
                  {}},
      false_cut_{"ideal false cut where",
                 {seed, "ideal false cut", statistics_.cuts.false_staying, false},
                 {}} {
  world_.gates.insert(world_.gates.end(), world.false_gates.begin(), world.false_gates.end());
}

Draws IdealVision::draws(const char* purpose, int which, double t) const {
  return {Stream{seed_, std::string{purpose} + " " + std::to_string(which)}, moment_of(t)};
}

SeenPicture IdealVision::look(double t_start, std::span<const BodyPose> history) {
  SeenPicture seen;
  auto views = gates_in_view(world_, camera_, sight_, t_start, history);
  std::erase_if(views, [&](const GateView& view) {
    return !world_.gates[static_cast<std::size_t>(view.gate)].sought;
  });
  add_gates(outliers_ > 0.0 ? with_outliers(views, t_start, history) : views, t_start, seen);
  add_frames_of_gates(views, t_start, seen);
  add_alarms(t_start, history, seen);
  add_parts(views, t_start, seen);
  add_cut(views, t_start, seen);
  std::stable_sort(seen.gates.begin(), seen.gates.end(),
                   [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
  if (one_answer_ && seen.gates.size() > 1) seen.gates.resize(1);
  return seen;
}

// Some of the gates in view, seen as if the drone were elsewhere.
std::vector<GateView> IdealVision::with_outliers(std::vector<GateView> views, double t_start,
                                                 std::span<const BodyPose> history) {
  constexpr double kFarthest = 3.0;  // [m]
  world::World moved = world_;
  Draws draw = draws("ideal outliers", 0, t_start);
  for (world::WorldGate& gate : moved.gates) {
    const Eigen::Vector3d direction{draw.normal(), draw.normal(), 0.3 * draw.normal()};
    gate.p_EG += kFarthest * draw.uniform() * direction.normalized();
  }
  const auto displaced = gates_in_view(moved, camera_, sight_, t_start, history);
  for (GateView& view : views) {
    if (draw.uniform() >= outliers_) continue;
    const auto elsewhere =
        std::find_if(displaced.begin(), displaced.end(),
                     [&](const GateView& other) { return other.gate == view.gate; });
    view.whole = view.whole && elsewhere != displaced.end() && elsewhere->whole;
    if (view.whole) view.corners_px = elsewhere->corners_px;
  }
  return views;
}

// Shared by the corners and each its own; some are far off.
IdealVision::Corners IdealVision::with_errors(const GateView& view, double t) {
  const CornerErrors& errors = statistics_.corners;
  Draws draw = draws("ideal corners", view.gate, t);
  const double right = right_.of(view.gate).normal(t), down = down_.of(view.gate).normal(t);
  const Eigen::Vector2d together = errors.together * Eigen::Vector2d{right, down};
  const double growth = errors.size * size_.of(view.gate).normal(t);
  const Eigen::Vector2d middle =
      0.25 * (view.corners_px[0] + view.corners_px[1] + view.corners_px[2] + view.corners_px[3]);
  Corners corners = view.corners_px;
  for (Eigen::Vector2d& corner : corners) {
    const Eigen::Vector2d own{draw.normal(), draw.normal()};
    corner += together + growth * (corner - middle).normalized() + errors.own * own;
    if (draw.uniform() >= errors.outlier_rate) continue;
    const auto [sine, cosine] = sincos(2 * kPi * draw.uniform());
    corner += draw.uniform(errors.outlier_low, errors.outlier_high) * Eigen::Vector2d{cosine, sine};
  }
  return corners;
}

// One of its sides is something else.
IdealVision::Corners IdealVision::crooked(const GateView& view, double t) {
  Draws draw = draws("ideal crooked side", view.gate, t);
  Corners corners = view.corners_px;
  const auto first = static_cast<std::size_t>(draw.uniform(0.0, 4.0)) % 4;
  const std::size_t second = (first + 1) % 4;
  const double by = draw.uniform(statistics_.crooked_low, statistics_.crooked_high) *
                    (draw.uniform() < 0.5 ? -1.0 : 1.0);
  const Eigen::Vector2d across =
      by *
      (corners[first] - corners[(first + 3) % 4] + corners[second] - corners[(second + 1) % 4]) /
      2.0;
  corners[first] += across, corners[second] += across;
  return corners;
}

IdealVision::Corners IdealVision::square_at(const Eigen::Vector2d& middle_px, double size,
                                            int which, Draws draw) {
  constexpr std::array<double, 4> kRight{-1, 1, 1, -1}, kDown{-1, -1, 1, 1};
  const double half = 0.5 * at(statistics_.alarm_side_px, size);
  const double slant = 0.1 * (which % 3 - 1);  // each its own shape
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d noise{draw.normal(), draw.normal()};
    corners[i] = middle_px +
                 half * Eigen::Vector2d{kRight[i], kDown[i] * (1.0 + slant * kRight[i])} +
                 statistics_.corners.own * noise;
  }
  return corners;
}

void IdealVision::add_gates(const std::vector<GateView>& views, double t, SeenPicture& seen) {
  const GateView* largest = largest_of(views);
  for (const GateView& view : views) {
    if (!view.whole && seen_corners(view) < 2) continue;
    double surplus = 0.0, rate = 0.0;
    bool found = false;
    const Quantiles* fitness = nullptr;
    if (&view == largest || (view.whole && detectable(view.corners_px))) {
      const SizeBin& bin = bin_of(&view == largest ? statistics_.gates : statistics_.others,
                                  side_of(view.corners_px));
      rate = bin.rate, fitness = &bin.fitness;
      found = gates_.happens(view.gate, rate, t, surplus);
    } else {
      const Finds& finds = view.whole ? statistics_.aslant : statistics_.hidden;
      rate = finds.rate, fitness = &finds.fitness;
      found = (view.whole ? aslant_ : hidden_).happens(view.gate, rate, t, surplus);
    }
    if (found)
      seen.gates.push_back({with_errors(view, t), at(*fitness, surplus)});
    else
      add_wrong_frame(view, 1.0 - rate, t, seen);
  }
}

// A detector gives one frame for a gate: a wrong one where it misses the right one.
void IdealVision::add_wrong_frame(const GateView& view, double missed, double t,
                                  SeenPicture& seen) {
  double surplus = 0.0;
  const double rate = std::min(1.0, statistics_.crooked.rate / std::max(missed, 1e-3));
  if (crooked_.happens(view.gate, rate, t, surplus))
    seen.gates.push_back({crooked(view, t), at(statistics_.crooked.fitness, surplus)});
}

// Frames that are no gates but made of gates' bars.
void IdealVision::add_frames_of_gates(const std::vector<GateView>& views, double t,
                                      SeenPicture& seen) {
  double surplus = 0.0;
  for (const LookAlike& frame : frames_of_two(views))
    if (two_gates_.happens(frame.which, statistics_.two_gates.rate, t, surplus))
      seen.gates.push_back({frame.corners_px, at(statistics_.two_gates.fitness, surplus)});
}

void IdealVision::add_alarms(double t, std::span<const BodyPose> history, SeenPicture& seen) {
  Exposure exposure{camera_, t, history};
  double surplus = 0.0;
  for (const LookAlike& decoy : decoys_in_view(world_, sight_, exposure))
    if (decoys_.happens(decoy.which, statistics_.decoys.rate, t, surplus)) {
      const Eigen::Vector2d middle = 0.5 * (decoy.corners_px[0] + decoy.corners_px[2]);
      const double size = places_[static_cast<std::size_t>(decoy.which) % places_.size()].size;
      seen.gates.push_back(
          {square_at(middle, size, decoy.which, draws("ideal decoy corners", decoy.which, t)),
           at(statistics_.decoys.fitness, surplus)});
    }
  for (const int place : places_in_view(places_, sight_, exposure))
    if (at_places_.happens(place, statistics_.places.rate, t, surplus)) {
      const Place& there = places_[static_cast<std::size_t>(place)];
      if (const auto middle = exposure.project(there.p_E))
        seen.gates.push_back(
            {square_at(*middle, there.size, place, draws("ideal place corners", place, t)),
             at(statistics_.places.fitness, surplus)});
    }
}

void IdealVision::add_parts(const std::vector<GateView>& views, double t, SeenPicture& seen) {
  const Parts &lower = statistics_.lower, &bars = statistics_.bars;
  Draws draw = draws("ideal parts", 0, t);
  const auto noise = [&] { return draw.normal(); };
  double surplus = 0.0;
  for (const GateView& view : views) {  // the nearest of each kind
    if (!seen.lower && view.only_lower_corners && view.distance < reach(kLowerCornersReach, view) &&
        lower_.happens(view.gate, lower.rate, t, surplus)) {
      const Eigen::Vector2d left{noise(), noise()}, right{noise(), noise()};
      seen.lower = {view.corners_px[3] + lower.sigma_px * left,
                    view.corners_px[2] + lower.sigma_px * right};
    }
    if (!seen.bars && view.bars_px && view.distance < reach(kBarsReach, view) &&
        bars_.happens(view.gate, bars.rate, t, surplus)) {
      const Eigen::Vector2d left{bars.sigma_px * noise(), 0.0}, right{bars.sigma_px * noise(), 0.0};
      seen.bars = {(*view.bars_px)[0] + left, (*view.bars_px)[1] + right};
    }
  }
  add_false_pair(false_lower_, lower.false_rate, t, seen.lower);
  add_false_pair(false_bars_, bars.false_rate, t, seen.bars);
}

// A part is one thing or another: what is none comes in place of the gate's.
// The largest gate that the border cuts counts: the part search gives one a picture.
void IdealVision::add_cut(const std::vector<GateView>& views, double t, SeenPicture& seen) {
  double surplus = 0.0;
  for (const GateView& view : views) {
    const auto kind = cut_kind(view.seen);
    if (!kind) continue;
    const CutBin& bin =
        cut_bin_of(statistics_.cuts.kinds[static_cast<std::size_t>(*kind)], view.side_px);
    if (!cut_.happens(view.gate, bin.rate, t, surplus)) continue;
    Draws draw = draws("ideal cut corners", view.gate, t);
    seen.cut = {view.corners_px, view.seen};
    for (Eigen::Vector2d& corner : seen.cut->corners_px)
      corner += bin.sigma_px * Eigen::Vector2d{draw.normal(), draw.normal()};
    return;
  }
  std::optional<SeenPicture::Pair> wrong;
  add_false_pair(false_cut_, statistics_.cuts.false_rate, t, wrong);
  if (wrong)
    seen.cut = {{wrong->left_px, wrong->right_px, wrong->right_px, wrong->left_px},
                {true, true, false, false}};
}

double IdealVision::reach(double of_1_m, const GateView& view) const {
  return build_ == GateBuild::kWide
             ? of_1_m * world_.gates[static_cast<std::size_t>(view.gate)].side
             : of_1_m;
}

void IdealVision::add_false_pair(FalsePair& kind, double rate, double t,
                                 std::optional<SeenPicture::Pair>& pair) {
  double surplus = 0.0;
  if (!kind.draws.happens(0, rate, t, surplus)) {
    kind.pair.reset();
    return;
  }
  if (!kind.pair) {
    Draws draw = draws(kind.where, 0, t);
    const double width = camera_.width() - 1, height = camera_.height() - 1;
    const double left = draw.uniform(0.0, width - kLeastGap),
                 right = draw.uniform(left + kLeastGap, width),
                 level = draw.uniform(0.3, 1.0) * height;
    kind.pair = {{left, level}, {right, level}};
  }
  pair = kind.pair;
}

}  // namespace gatefly::sim
