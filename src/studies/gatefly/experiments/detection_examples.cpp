// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/detection_examples.hpp"

#include <algorithm>
#include <vector>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/drawing/canvas.hpp"

namespace gatefly::experiments {
namespace {

constexpr files::Rule kRule = files::Rule::kOverlap70Authors;

/// A detection of the first run.
struct Candidate {
  std::size_t picture;
  GateDetection gate;
};

bool fits(const GateDetection& gate, const std::vector<Quad>& labels) {
  return std::any_of(labels.begin(), labels.end(), [&](const Quad& label) {
    return files::matches(gate.corners_px, label, kRule);
  });
}

bool touches(const GateDetection& gate, const std::vector<Quad>& gates) {
  return std::any_of(gates.begin(), gates.end(), [&](const Quad& other) {
    return files::polygon_shared_area(gate.corners_px, other) > 0.0;
  });
}

/// The mask: what the paper's colour box takes for the gate's, white on black.
void draw_mask(drawing::Canvas& canvas, const Image& image, const ColorRange& color,
               const Eigen::Vector2d& at, double scale) {
  canvas.fill({at.x(), at.y(), scale * image.width(), scale * image.height()}, {0, 0, 0});
  for (int v = 0; v < image.height(); ++v)
    for (int u = 0; u < image.width(); ++u)
      if (color.contains(image.at(u, v)))
        canvas.fill({at.x() + scale * u, at.y() + scale * v, scale, scale}, drawing::kDark.ink);
}

}  // namespace

std::array<DetectionExample, 3> detection_examples(
    const LabelledSet& set, const std::vector<Found>& runs,
    const std::vector<std::vector<Quad>>& unlabelled) {
  std::vector<Candidate> hits, wrong;
  DetectionExample missed{.kind = "missed", .rule = "largest gate that no run finds"};
  double largest = 0.0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const std::vector<Quad>& labels = set.labels.pictures[i].gates;
    for (const GateDetection& gate : runs.front()[i])
      if (fits(gate, labels))
        hits.push_back({i, gate});
      else if (!touches(gate, labels) && !touches(gate, unlabelled[i]))
        wrong.push_back({i, gate});
    if (labels.empty() || files::polygon_area(labels.front()) <= largest) continue;
    const bool found = std::any_of(runs.begin(), runs.end(), [&](const Found& run) {
      return std::any_of(run[i].begin(), run[i].end(),
                         [&](const GateDetection& gate) { return fits(gate, labels); });
    });
    if (!found) missed.picture = i, largest = files::polygon_area(labels.front());
  }
  DetectionExample hit{.kind = "hit", .rule = "median colour fitness"},
      false_positive{.kind = "false positive", .rule = "highest fitness away from known gates"};
  const auto less_fit = [](const Candidate& a, const Candidate& b) {
    return a.gate.fitness < b.gate.fitness;
  };
  std::stable_sort(hits.begin(), hits.end(), less_fit);
  if (!hits.empty()) {
    const Candidate& median = hits[hits.size() / 2];
    hit.picture = median.picture, hit.found = median.gate;
  }
  const auto fittest = std::max_element(wrong.begin(), wrong.end(), less_fit);
  if (fittest != wrong.end())
    false_positive.picture = fittest->picture, false_positive.found = fittest->gate;
  return {hit, false_positive, missed};
}

drawing::Canvas drawn_examples(const LabelledSet& set, const Found& found,
                               const std::array<DetectionExample, 3>& examples,
                               const ColorRange& color) {
  constexpr int kGap = 12, kTop = 92, kCaption = 40, kScale = 2;
  constexpr double kLetters = 19.0;
  int width = 1, height = 1;
  for (const DetectionExample& example : examples)
    if (example.picture) {
      const Image image = set.picture(*example.picture);
      width = std::max(width, kScale * image.width());
      height = std::max(height, kScale * image.height());
    }
  drawing::Canvas canvas(3 * (width + kGap) + kGap, kTop + kCaption + 2 * (height + kGap));
  canvas.text({kGap, 38.0}, "Detections of mode paper (σ_L 25 px, σ_cf 0.7) and their masks",
              {.size = 28.0, .bold = true});
  canvas.text({kGap, 74.0}, "green: label; blue: detected; orange: false positive",
              {.color = drawing::kLight.muted, .size = kLetters});
  for (std::size_t k = 0; k < examples.size(); ++k) {
    const DetectionExample& example = examples[k];
    const Eigen::Vector2d caption{kGap + static_cast<double>(k) * (width + kGap), kTop + 26.0},
        at{caption.x(), kTop + kCaption};
    if (!example.picture) {
      canvas.text(caption, example.kind + ": none", {.size = kLetters});
      continue;
    }
    const Image image = set.picture(*example.picture);
    const files::LabelledPicture& label = set.labels.pictures[*example.picture];
    canvas.text(caption,
                example.kind + ": " + example.rule + ", " + label.image +
                    (example.found ? ", cf " + fixed(example.found->fitness, 2) : ""),
                {.size = kLetters});
    canvas.clip({at.x(), at.y(), static_cast<double>(width), static_cast<double>(height)});
    canvas.image(image, at, kScale);
    for (const Quad& gate : label.gates)
      drawing::draw_detection(canvas, {.corners_px = gate}, at, kScale,
                              {.color = drawing::kDark.flown, .width = 1.5});
    for (const GateDetection& gate : found[*example.picture])
      drawing::draw_detection(
          canvas, gate, at, kScale,
          {.color = fits(gate, label.gates) ? drawing::kDark.found : drawing::kDark.gate_solid,
           .width = 2.0});
    canvas.unclip();
    draw_mask(canvas, image, color, at + Eigen::Vector2d{0.0, height + kGap}, kScale);
  }
  return canvas;
}

}  // namespace gatefly::experiments
