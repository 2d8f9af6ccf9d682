// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/careful_search.hpp"

#include <algorithm>

#include "gatefly/detection/outline.hpp"

namespace gatefly {
namespace {

constexpr std::size_t kTried = 48;  // places that are looked at closely [of 24, 48, 96: two thirds of the cost of 96, a gate in 300 less]

struct Fitted {
  Quad quad;
  FrameScore score;
};

bool same_place(const Quad& a, const Quad& b) {
  const double shared = shared_area(a, b);
  return shared > 0.5 * std::min(std::abs(area(a)), std::abs(area(b)));
}

// Part of such frames that were gates, on the authors' labelled pictures.
double confidence_of(double score) { return 1.0 / (1.0 + std::exp(-2.2 * (score - 2.45))); }

bool is_inside(const Quad& bars, const Image& image) {
  return std::all_of(bars.begin(), bars.end(), [&](const auto& p) {
    return p.x() >= 1.0 && p.y() >= 1.0 && p.x() <= image.width() - 2.0 && p.y() <= image.height() - 2.0;
  });
}

bool better(const Fitted& a, const Fitted& b) { return a.score.total > b.score.total; }

// Of two frames in one place: a post in the opening makes a frame of each half, so size counts.
bool better_here(const Fitted& a, const Fitted& b) {
  constexpr double kNatsPerDoubling = 0.5;  // [of 0, .5, 1, 1.7: the most gates of all labelled sets]
  const auto worth = [](const Fitted& f) { return f.score.total + kNatsPerDoubling * std::log2(std::max(1.0, std::abs(area(f.quad)))); };
  return worth(a) > worth(b);
}

// Side by side onto the evidence, as long as it helps. Lengths in cells.
template <class Fit>
Fitted pulled(const Fit& fit, Fitted f, double least_side, double most_aspect) {
  const double size = std::sqrt(std::abs(area(f.quad)));
  for (const double part : {0.16, 0.12, 0.08}) {
    const auto moved = fit.moved(f.quad, std::clamp(static_cast<int>(part * size + 0.5), 1, 5));
    if (!moved || !is_frame_shaped(*moved, least_side, most_aspect)) break;
    const FrameScore now = fit.score(*moved);
    if (now.total <= f.score.total) break;
    f = {*moved, now};
  }
  return f;
}

}  // namespace

GateDetections CarefulSearch::detect(const Image& image, const ColorModel& color) {
  GateDetections found;
  map_.fill(image, color);
  if (map_.width() == 0) return found;
  GateCandidates candidates;
  templates_.search(map_, params_.max_roll_deg, candidates);

  const double step = map_.step(), least_side = params_.min_side_px / step;
  const auto to_cells = [step](Quad q) {
    for (auto& p : q) p = ((p.array() + 0.5) / step - 0.5).matrix();
    return q;
  };
  const auto to_pixels = [step](Quad q) {
    for (auto& p : q) p = ((p.array() + 0.5) * step - 0.5).matrix();
    return q;
  };
  const auto cell_evidence = [this](int x, int y) { return map_.at(x, y); };
  const auto pixel_evidence = [&](int u, int v) { return map_.at_pixel(image, color, u, v); };
  const FrameFit<decltype(cell_evidence)> coarse{cell_evidence, params_.weights};
  FrameFit<decltype(pixel_evidence)> fine{pixel_evidence, params_.weights};
  fine.set_least_offset(3.0);

  FixedList<Fitted, 8> best;
  for (std::size_t i = 0; i < std::min(candidates.size(), kTried); ++i) {
    const Quad q = to_cells(candidates[i].corners_px);
    const Fitted fitted = pulled(coarse, {q, coarse.score(q)}, least_side, params_.max_aspect);
    if (!is_frame_shaped(fitted.quad, least_side, params_.max_aspect)) continue;
    const auto known = std::find_if(best.begin(), best.end(), [&](const Fitted& b) { return same_place(b.quad, fitted.quad); });
    if (known != best.end()) {
      if (better_here(fitted, *known)) *known = fitted;
    } else if (!best.push_back(fitted)) {
      const auto worst = std::max_element(best.begin(), best.end(), better);
      if (better(fitted, *worst)) *worst = fitted;
    }
  }
  insertion_sort(best, better);

  for (const Fitted& coarse_fit : best) {
    if (found.full() || coarse_fit.score.total < params_.min_score - 1.5) break;
    Quad q = to_pixels(coarse_fit.quad);
    FrameScore score = fine.score(q);
    for (const int reach : {3, 2, 1}) {
      const auto moved = fine.moved(q, reach);
      if (!moved || !is_frame_shaped(*moved, params_.min_side_px, params_.max_aspect)) break;
      const FrameScore now = fine.score(*moved);
      if (now.total > score.total) q = *moved, score = now;
    }
    const double size = std::sqrt(std::abs(area(q)));
    const auto centered = fine.centered(q, std::clamp(static_cast<int>(0.07 * size + 0.5), 2, 5));
    if (centered && is_frame_shaped(*centered, params_.min_side_px, params_.max_aspect)) {
      const FrameScore now = fine.score(*centered);
      if (now.total > score.total - 0.3) q = *centered, score = now;
    }
    if (score.total < params_.min_score || score.inside > params_.max_inside) continue;
    (void)found.push_back({clockwise_from_top_left(scaled(q, params_.corner_scale)), confidence_of(score.total), is_inside(q, image)});
  }
  insertion_sort(found, [](const auto& a, const auto& b) { return a.color_fitness > b.color_fitness; });
  return found;
}

}  // namespace gatefly
