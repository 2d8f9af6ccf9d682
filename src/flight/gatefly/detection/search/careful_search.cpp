// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/careful_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/corner_refinement.hpp"
#include "gatefly/detection/search/filled_frame.hpp"
#include "gatefly/detection/search/frame_fit.hpp"
#include "gatefly/detection/search/frame_pull.hpp"
#include "gatefly/detection/search/meant_detection.hpp"
#include "gatefly/geometry/exponential.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

// A score on cells, which thin bars hardly fill, beside that of the finished frame. In a window the smaller
// one passes over half of the frames that lead to nothing. [ours: of 398 gates found in windows of ten rendered races
// one lacked more]
constexpr double kRoughLacks = 2.0, kRoughLacksInWindow = 1.2;

constexpr double kWideBar = 4.0;  // cells; wider ones need no look at single pixels

// Score of the templates from which on a frame of such a score may come. [of 102, 112, 128 at 2.5: the
// highest that loses no gate of the labelled sets, whole and spoilt in 24 ways; a third of the time of
// all places]
int least_worth_a_look(double min_score) {
  constexpr double kAtZero = 72.0, kPerNat = 16.0;
  return static_cast<int>(std::clamp(kAtZero + kPerNat * min_score, 80.0, 144.0));
}

// Across the picture's width, of lenses that are tried where none is named: what lies between is
// within the width of a large frame's bars. [rad]
constexpr std::array kGuesses{100.0 * kDegree, 140.0 * kDegree, 175.0 * kDegree};
// A bend has to be that much better than none: it follows noise, too [nats].
constexpr double kGuessDoubt = 1.0;

// Cells; corners that bent sides move less than so far are reached from straight ones.
constexpr double kMuchBent = 2.0;
constexpr double kShows = 1.0;  // the same of a lens that nobody named

// Places that are looked at closely in a window for one gate, and in any other window. [ours: with 16 and
// 24 the same gates are found in a rendered race]
constexpr std::size_t kPlacesForOne = 8, kPlacesOfPart = 16;
// Frames of a window that are looked at on pixels: one more than those 398 gates needed, for more than one
// gate may show in it.
constexpr std::size_t kFramesOfWindow = 3;

bool better(const Frame& a, const Frame& b) { return a.score.total > b.score.total; }

// Two frames in one place compare by size, too: a post in the opening makes a frame of each half.
bool better_here(const Frame& a, const Frame& b) {
  // [of 0, .5, 1, 1.7: the most gates of all labelled sets]
  constexpr double kNatsPerDoubling = 0.5;
  const auto worth = [](const Frame& f) {
    return f.score.total + kNatsPerDoubling * gatefly::log2(std::max(1.0, std::abs(area(f.quad))));
  };
  return worth(a) > worth(b);
}

// Corners of a bent frame. A template's sides are straight, and lie as they fit bent ones
// best: outside the chord from corner to corner.
Quad bowed(const Quad& straight, const SideCurves& curves) {
  constexpr double kBestLine = 2.0 / 3.0;  // of the sag, for a parabola
  Quad corners = straight;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d sag = kBestLine * curves.sag(straight[i], straight[(i + 1) % 4]);
    corners[i] -= sag, corners[(i + 1) % 4] -= sag;
  }
  return corners;
}

using BestFrames = FixedList<Frame, 8>;

// One frame a place, the best ones.
void keep(BestFrames& best, const Frame& frame) {
  const auto known = std::find_if(best.begin(), best.end(),
                                  [&](const Frame& b) { return same_place(b.quad, frame.quad); });
  if (known != best.end()) {
    if (better_here(frame, *known)) *known = frame;
  } else if (!best.push_back(frame)) {
    const auto worst = std::max_element(best.begin(), best.end(), better);
    if (better(frame, *worst)) *worst = frame;
  }
}

// One picture, from places to gates.
class Look {
 public:
  Look(const EvidenceMap& map, const Image& image, const PictureColor& color,
       const GateDetectorParams& params, const LensBend& bend, const std::vector<LensBend>& guesses,
       bool in_window, SearchTrace* trace)
      : map_{map},
        image_{image},
        color_{color},
        params_{params},
        bend_{bend},
        guesses_{guesses},
        in_window_{in_window},
        trace_{trace},
        step_{static_cast<double>(map.step())},
        least_side_{params.min_side_px / step_},
        of_cell_{map},
        coarse_{of_cell_, params.weights_with(color.faintness()), params.bar()} {
    coarse_.set_cell_size(step_);
    coarse_.set_bounds(map.width(), map.height());
  }

  // Frames on cells, the best first. Not inlined, nor is gates(): their working memory must be off
  // the stack again when corners are refined, which takes 15 KB itself.
  [[gnu::noinline]] BestFrames rough(const GateCandidates& candidates) {
    const SideCurves curves{bend_, image_, step_};
    coarse_.set_curves(curves);
    BestFrames best;
    for (const GateCandidate& candidate : candidates) {
      const Frame frame = led_to_from(to_cells(candidate.corners_px, step_), curves);
      const bool has_shape = is_frame_shaped(frame.quad, least_side_, params_.max_aspect);
      if (has_shape) keep(best, frame);
      if (trace_ != nullptr)
        (void)trace_->places.push_back(
            {candidate.corners_px, to_pixels(frame.quad, step_), frame.score, has_shape});
    }
    insertion_sort(best, better);
    // At most once a frame kept.
    while (in_window_ && best.size() > kFramesOfWindow) best.pop_back();
    return best;
  }

  // Keeps those that are gates, on pixels.
  [[gnu::noinline]] BestFrames gates(const BestFrames& best) {
    const auto of_pixel = [this](int u, int v) { return map_.at_pixel(image_, color_, u, v); };
    FrameFit<decltype(of_pixel)> fine{of_pixel, params_.weights_with(color_.faintness()),
                                      params_.bar()};
    fine.set_least_offset(3.0);
    fine.set_bounds(image_.width(), image_.height());
    const double least_rough = params_.min_score - (in_window_ ? kRoughLacksInWindow : kRoughLacks);
    if (trace_ != nullptr) trace_->least_rough = least_rough;
    BestFrames gates;
    for (const Frame& rough : best) {
      if (rough.score.total < least_rough) break;
      const SideCurves curves = curves_of(rough, 1.0);
      Frame frame;
      if (params_.bar() * std::sqrt(std::abs(area(rough.quad))) > kWideBar) {
        coarse_.set_curves(curves_of(rough, step_));
        frame = finished(coarse_, rough.quad, least_side_, params_);
        frame.quad = to_pixels(frame.quad, step_);
      } else {
        fine.set_curves(curves);
        frame = finished(fine, to_pixels(rough.quad, step_), params_.min_side_px, params_);
      }
      frame.guess = rough.guess;
      frame.score.take_off(lost_as_filled(image_, frame.quad, params_.bar(), curves));
      const bool taken =
          frame.score.total >= params_.min_score && frame.score.inside <= params_.max_inside;
      if (trace_ != nullptr)
        (void)trace_->finished.push_back(
            {to_pixels(rough.quad, step_), frame.quad, frame.score, taken});
      if (taken) keep(gates, frame);  // some come to one place only now
    }
    insertion_sort(gates, better);
    return gates;
  }

  GateDetection refined(Frame frame) const {
    const SideCurves curves = curves_of(frame, 1.0);
    frame.quad =
        refined_corners(image_, frame.quad, params_.bar(), RefinementEffort::kCareful, curves);
    return meant_detection(frame, DetectionMethod::kFrames, image_, params_, curves);
  }

 private:
  struct OfCell {
    const EvidenceMap& map;
    int operator()(int x, int y) const { return map.at(x, y); }
    template <class Visit>
    void along(std::int64_t x, std::int64_t y, std::int64_t dx, std::int64_t dy, int count,
               const Visit& visit) const {
      map.along(x, y, dx, dy, count, visit);
    }
  };

  Frame pulled_from(const Quad& q) const {
    return pulled(coarse_, {q, coarse_.score(q)}, least_side_, params_.max_aspect);
  }

  // The best frame that a place leads to: as it is, bent by the lens, or by one that it may be.
  Frame led_to_from(const Quad& straight, const SideCurves& curves) {
    Frame frame = pulled_from(straight);
    if (const Quad bent = bowed(straight, curves); largest_move(bent, straight) > kMuchBent) {
      const Frame other = pulled_from(bent);
      if (better(other, frame)) frame = other;
    }
    for (std::size_t k = 0; k < guesses_.size(); ++k) {
      const SideCurves guess{guesses_[k], image_, step_};
      const Quad start = bowed(straight, guess);
      if (!(largest_move(start, straight) > kShows)) continue;
      coarse_.set_curves(guess);
      Frame other = pulled_from(start);
      other.guess = static_cast<int>(k);
      other.score.total -= kGuessDoubt;
      if (better(other, frame)) frame = other;
      coarse_.set_curves(curves);
    }
    return frame;
  }

  SideCurves curves_of(const Frame& frame, double cell) const {
    if (frame.guess < 0) return SideCurves{bend_, image_, cell};
    return SideCurves{guesses_[static_cast<std::size_t>(frame.guess)], image_, cell}.guessed();
  }

  const EvidenceMap& map_;
  const Image& image_;
  const PictureColor& color_;
  const GateDetectorParams& params_;
  const LensBend& bend_;
  const std::vector<LensBend>& guesses_;
  bool in_window_;
  SearchTrace* trace_;
  double step_, least_side_;  // a cell [px], the least side [cells]
  OfCell of_cell_;
  FrameFit<OfCell> coarse_;
};

}  // namespace

CarefulSearch::CarefulSearch(const GateDetectorParams& params)
    : params_{params}, templates_{params.max_roll_deg}, bend_{params.lens} {
  if (bend_.is_known()) return;
  for (const double angle : kGuesses) guesses_.emplace_back(equidistant_lens(angle));
}

GateDetections CarefulSearch::detect(const Image& image, const PictureColor& color,
                                     const SearchWindow* within, SearchTrace* trace) {
  GateDetections found;
  map_.fill(image, color, within);
  if (map_.filled().empty()) return found;
  candidates_.clear();
  templates_.search(map_, least_worth_a_look(params_.min_score), candidates_, within);
  if (within != nullptr)
    // At most once a candidate.
    while (candidates_.size() > (within->for_one ? kPlacesForOne : kPlacesOfPart))
      candidates_.pop_back();
  Look look{map_, image, color, params_, bend_, guesses_, within != nullptr, trace};
  for (const Frame& gate : look.gates(look.rough(candidates_)))
    (void)found.push_back(look.refined(gate));
  return found;
}

}  // namespace gatefly
