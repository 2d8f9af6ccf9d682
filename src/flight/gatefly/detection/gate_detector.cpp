// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/gate_detector.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "gatefly/detection/paper/paper_detector.hpp"
#include "gatefly/detection/paper/side_bars.hpp"
#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/detection/search/opening_search.hpp"
#include "gatefly/detection/search/part_search.hpp"
#include "gatefly/detection/search/snake_search.hpp"

namespace gatefly {
namespace {

// Seed of the paper's random samples, the same for every picture: an answer does not depend on the
// pictures before.
constexpr std::uint64_t kSeed = 1;

// In the paper's corners.
std::optional<Quad> previous_of(const LookFor& look_for, const GateDetectorParams& params) {
  if (look_for.previous == nullptr) return std::nullopt;
  return scaled(*look_for.previous, 1.0 / params.corner_scale);
}

// Never inlined: the paper's list has 200 KB, which our modes shall not have on their stack.
[[gnu::noinline]] void list_as_paper(const Image& image, Rng& rng,
                                     std::vector<GateDetection>& gates) {
  PaperDetections found = detect_as_paper(image, {}, rng);
  insertion_sort(found, [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
  gates.assign(found.begin(), found.end());
}

// In a full list the least sure one makes room.
void add(GateDetections& gates, const GateDetection& gate) {
  if (gates.push_back(gate)) return;
  const auto least = std::min_element(gates.begin(), gates.end(), [](const auto& a, const auto& b) {
    return a.fitness < b.fitness;
  });
  if (least->fitness < gate.fitness) *least = gate;
}

}  // namespace

struct GateDetector::Searches {
  explicit Searches(const GateDetectorParams& params)
      : snakes{params}, careful{params}, parts{params}, openings{params} {}

  PictureColor color;  // of the picture that is looked at
  SnakeSearch snakes;
  CarefulSearch careful;
  PartSearch parts;
  OpeningSearch openings;
};

GateDetector::GateDetector(const GateDetectorParams& params, DetectorMode mode)
    : params_{params}, mode_{mode}, searches_{std::make_unique<Searches>(params)} {
  gates_.reserve(mode == DetectorMode::kPaper ? PaperDetections::kCapacity
                                              : GateDetections::kCapacity);
}
GateDetector::GateDetector(GateDetector&&) noexcept = default;
GateDetector& GateDetector::operator=(GateDetector&&) noexcept = default;
GateDetector::~GateDetector() = default;

GatesInView GateDetector::look(const Image& image, const ColorModel& color,
                               const LookFor& look_for) & {
  gates_.clear();
  careful_ = false;
  if (!is_paper() && !look_for.again)
    searches_->color.set(color, params_.adapts ? tone_of(image, color) : ChromaTone{});
  if (look_for.gates != LookFor::Gates::kNone) list_gates(image, look_for);
  if (look_for.gates == LookFor::Gates::kBest && gates_.size() > 1) gates_.resize(1);

  GatesInView view{.gates = gates_, .part = {}, .openings = {}, .careful = careful_};
  if (look_for.part == LookFor::Part::kNo) return view;
  if (look_for.part == LookFor::Part::kWithoutGate && !gates_.empty()) return view;
  view.part = part(image);
  if (!parts_have_corners()) return view;  // none to compare
  view.openings = searches_->openings.detect(image, searches_->color);
  const auto is_part_of = [&](const GateDetection& gate) {
    return view.part && same_place(gate.corners_px, view.part->gate.corners_px);
  };
  if (std::any_of(gates_.begin(), gates_.end(), is_part_of)) view.part.reset();
  return view;
}

bool GateDetector::is_paper() const {
  return mode_ == DetectorMode::kPaper || mode_ == DetectorMode::kFlown;
}

std::optional<GatePart> GateDetector::part(const Image& image) {
  if (!is_paper()) return searches_->parts.detect(image, searches_->color);
  Rng rng{kSeed};
  SideBarsParams params;
  if (mode_ == DetectorMode::kPaper) params.color = PaperDetectorParams{}.color;
  const auto bars = side_bars_by_histogram(image, params, rng);
  if (!bars) return std::nullopt;
  const double left = bars->left_px.x(), right = bars->right_px.x(), bottom = image.height() - 1;
  const GateDetection cut{.corners_px = {{{left, 0}, {right, 0}, {right, bottom}, {left, bottom}}},
                          .corner_fitness = {},
                          .method = DetectionMethod::kBars,
                          .whole = false};
  return GatePart{cut, *bars};
}

void GateDetector::list_gates(const Image& image, const LookFor& look_for) {
  Rng rng{kSeed};
  // One list, whoever fills it: on the stack each would count.
  const auto found = [&]() -> GateDetections {
    if (mode_ == DetectorMode::kFast) return searches_->snakes.detect(image, searches_->color);
    return mode_ == DetectorMode::kOurs ? ours(image, look_for) : everywhere(image);
  };
  const auto list = [&](const GateDetections& gates) { gates_.assign(gates.begin(), gates.end()); };
  switch (mode_) {
    case DetectorMode::kOurs:
    case DetectorMode::kFast:
    case DetectorMode::kCareful:
      return list(found());
    case DetectorMode::kPaper:
      list_as_paper(image, rng, gates_);
      break;
    case DetectorMode::kFlown:
      if (const auto gate = detect_as_flown(image, {}, rng, previous_of(look_for, params_)))
        gates_.push_back(*gate);
  }
  // The paper's corners are where the middle lines of the bars cross.
  for (GateDetection& gate : gates_)
    gate.corners_px = scaled(gate.corners_px, params_.corner_scale);
}

GateDetections GateDetector::ours(const Image& image, const LookFor& look_for) {
  const LookFor::Gates wanted = look_for.gates;
  const SearchWindow* const within = look_for.within;
  if (wanted == LookFor::Gates::kAll && !look_for.quick && within == nullptr)
    return everywhere(image);
  GateDetections quick = searches_->snakes.detect(image, searches_->color);
  const bool sure = !quick.empty() && is_sure(quick[0]);
  const bool expected_is_found = (!sure || within != nullptr) &&
                                 look_for.expected_bars != nullptr &&
                                 add_expected(*look_for.expected_bars, image, quick);
  if (expected_is_found && within == nullptr) return quick;
  if (look_for.quick) return in_order(quick, image);
  if (expected_is_found && wanted != LookFor::Gates::kAll && is_sure(quick[0])) return quick;
  if (within != nullptr) return with_gates_beside(quick, image, within);
  if (!sure) return everywhere(image);
  // A strong bar beside the gates found may be another gate's. Who knows which gate to expect need
  // not ask.
  if (wanted == LookFor::Gates::kBest && searches_->snakes.shows_bars_beside(quick))
    return with_gates_beside(quick, image, nullptr);
  return in_order(quick, image);
}

// If the expected gate is found, moves it to the front and returns true.
bool GateDetector::add_expected(const Quad& bars_px, const Image& image,
                                GateDetections& gates) const {
  const auto gate = searches_->snakes.detect_near(bars_px, image, searches_->color);
  if (!gate) return false;
  const auto same = std::find_if(gates.begin(), gates.end(), [&](const GateDetection& other) {
    return same_place(other.corners_px, gate->corners_px);
  });
  if (same == gates.end()) {
    if (gates.full()) gates.pop_back();
    (void)gates.push_back(*gate);
    std::rotate(gates.begin(), gates.end() - 1, gates.end());
  } else {
    if (gate->fitness > same->fitness) *same = *gate;
    std::rotate(gates.begin(), same, same + 1);
  }
  return true;
}

GateDetections GateDetector::everywhere(const Image& image) {
  careful_ = true;
  return in_order(searches_->careful.detect(image, searches_->color), image);
}

// Keeps the sure gates of the fast search unless the careful one is surer of a gate in the same place;
// where only a part of the picture is searched, the others, too.
GateDetections GateDetector::with_gates_beside(const GateDetections& quick, const Image& image,
                                               const SearchWindow* within) {
  careful_ = true;
  GateDetections all = searches_->careful.detect(image, searches_->color, within);
  for (const GateDetection& gate : quick) {
    if (within == nullptr && !is_sure(gate)) continue;
    const auto same = std::find_if(all.begin(), all.end(), [&](const auto& other) {
      return same_place(other.corners_px, gate.corners_px);
    });
    if (same == all.end())
      add(all, gate);
    else if (gate.fitness > same->fitness)
      *same = gate;
  }
  return in_order(all, image);
}

bool GateDetector::is_sure(const GateDetection& gate) const {
  // A side that shows far less than the others may lie beside its bar. 0: out of view.
  constexpr double kSureCorner = 0.85;
  return gate.fitness >= confidence_of(params_.sure_score) &&
         std::all_of(gate.corner_fitness.begin(), gate.corner_fitness.end(),
                     [](double corner) { return corner == 0.0 || corner >= kSureCorner; });
}

// Best first. Sure gates are ordered by distance from the middle: their scores differ only by the
// picture's noise.
GateDetections GateDetector::in_order(GateDetections gates, const Image& image) const {
  const Eigen::Vector2d middle{0.5 * (image.width() - 1), 0.5 * (image.height() - 1)};
  const auto off = [&](const GateDetection& gate) {
    return (center(gate.corners_px) - middle).squaredNorm();
  };
  insertion_sort(gates, [&](const GateDetection& a, const GateDetection& b) {
    if (is_sure(a) && is_sure(b)) return off(a) < off(b);
    return a.fitness > b.fitness;
  });
  return gates;
}

}  // namespace gatefly
