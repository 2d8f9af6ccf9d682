// SPDX-License-Identifier: Apache-2.0
// The real pictures where our detector is most wrong; causes, seen by eye: docs/paper/failures.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/detection/search/frame_fit.hpp"
#include "gatefly/drawing/annotate.hpp"
#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kAllowedInSet = 0.02;  // the threshold of each set
constexpr std::size_t kWorst = 20;

struct Failure {
  std::string set, image;
  bool miss = false;  ///< Else a false positive.
  double by = 0.0;    ///< How far on the wrong side of the threshold [score].
  double score = 0.0, threshold = 0.0;
  std::optional<Quad> label = {}, found = {};
  double side_px = 0.0, aspect = 0.0, evidence = 0.0;  ///< The label's, else the found one's.
  std::size_t set_number = 0, picture = 0;
};

double aspect_of(const Quad& q) {
  double least = 1e9, most = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    least = std::min(least, (q[(i + 1) % 4] - q[i]).norm()),
    most = std::max(most, (q[(i + 1) % 4] - q[i]).norm());
  return most / std::max(1e-9, least);
}

/// Mean evidence along the bars by the described colours [nats].
double evidence_along(const OwnSet& set, const Image& image, const Quad& corners) {
  EvidenceMap map;
  const ColorModel& color = set.config.pilot.gate_color;
  map.fill(image, color);
  const auto evidence = [&](int u, int v) { return map.at_pixel(image, color, u, v); };
  const FrameFit<decltype(evidence)> fit{evidence};
  return fit.score(scaled(corners, 1.0 / set.config.pilot.detector.corner_scale)).mean;
}

void add_failures(const OwnSet& set, std::size_t number, std::vector<Failure>& failures) {
  const std::vector<tuning::Judged> judged = judged_by_halves(set, Colors::kLabels);
  const double threshold =
      tuning::roc_of(judged, set.size(), set.gates()).at(kAllowedInSet).min_score;
  std::vector<const tuning::Judged*> best(set.size(), nullptr);
  std::vector<bool> is_hit(set.size(), false);
  for (const tuning::Judged& found : judged) {
    if (best[found.picture] == nullptr || (found.hit > 0.0 && best[found.picture]->hit < 1.0))
      best[found.picture] = &found;
    if (found.hit > 0.0 && found.score >= threshold) is_hit[found.picture] = true;
  }
  for (std::size_t i = 0; i < set.size(); ++i) {
    const tuning::LabelledImage& picture = set.picture(i);
    const tuning::Judged* found = best[i];
    Failure failure{.set = set.name,
                    .image = set.names[i],
                    .threshold = threshold,
                    .set_number = number,
                    .picture = i};
    if (found != nullptr) failure.score = found->score, failure.found = found->corners_px;
    const bool is_false = found != nullptr && found->wrong > 0.0 && found->score >= threshold;
    if (!picture.truth.gates.empty()) failure.label = files::polygon(picture.truth.gates[0]);
    if (is_false)
      failure.by = found->score - threshold;
    else if (failure.label && !is_hit[i])
      failure.miss = true,
      failure.by =
          threshold - (found != nullptr && found->hit > 0.0 ? found->score : set.judging.lowest);
    else
      continue;
    const Quad& about = failure.label ? *failure.label : *failure.found;
    failure.side_px = std::sqrt(files::polygon_area(about)), failure.aspect = aspect_of(about);
    failure.evidence = evidence_along(set, picture.image, about);
    failures.push_back(std::move(failure));
  }
}

drawing::Canvas sheet(const std::vector<OwnSet>& sets, const std::vector<Failure>& failures) {
  constexpr int kColumns = 4, kScale = 2, kWidth = 640, kHeight = 364, kTop = 100;
  const int rows = std::max(1, (static_cast<int>(failures.size()) + kColumns - 1) / kColumns);
  drawing::Canvas canvas(kColumns * kWidth, kTop + rows * kHeight);
  canvas.text({10.0, 46.0}, "Where our detector is most wrong, colours fitted to the other half",
              {.size = 36.0, .bold = true});
  canvas.text({10.0, 84.0},
              failures.empty() ? "in these sets no gate is missed, and nothing else is found"
                               : "green: label; pink: found; score and the least that counts",
              {.color = drawing::kLight.muted, .size = 26.0});
  for (std::size_t i = 0; i < failures.size(); ++i) {
    const Failure& f = failures[i];
    const Eigen::Vector2d at{static_cast<double>(static_cast<int>(i) % kColumns * kWidth),
                             static_cast<double>(kTop + static_cast<int>(i) / kColumns * kHeight)};
    canvas.clip({at.x(), at.y(), kWidth, kHeight});
    canvas.image(sets[f.set_number].picture(f.picture).image, at, kScale);
    if (f.label)
      drawing::draw_detection(canvas, {.corners_px = *f.label}, at, kScale,
                              {.color = drawing::kDark.flown, .width = 2.0});
    if (f.found)
      drawing::draw_detection(canvas, {.corners_px = *f.found}, at, kScale,
                              {.color = drawing::kDark.estimate, .width = 2.0});
    canvas.text(at + Eigen::Vector2d{4, kHeight - 14.0},
                std::to_string(i + 1) + " " + f.set + " " + f.image +
                    (f.miss ? " missed, " : " false, ") + fixed(f.score, 2) + " / " +
                    fixed(f.threshold, 2),
                {.size = 22.0});
    canvas.unclip();
  }
  return canvas;
}

}  // namespace

Result detection_failures(const Options& options) {
  std::vector<OwnSet> sets;
  std::vector<Failure> failures;
  const std::size_t count = options.quick ? 2 : own_set_names().size() - 1;  // the paper's own
  for (std::size_t s = 0; s < count; ++s) {
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(s) / static_cast<double>(count), own_set_names()[s]);
    sets.push_back(own_set(own_set_names()[s], options));
    add_failures(sets.back(), s, failures);
  }
  const auto misses = static_cast<std::size_t>(
      std::count_if(failures.begin(), failures.end(), [](const Failure& f) { return f.miss; }));
  // Misses by how far below the threshold, of equals the larger gate first.
  std::stable_sort(failures.begin(), failures.end(), [](const Failure& a, const Failure& b) {
    return a.by != b.by ? a.by > b.by : a.side_px > b.side_px;
  });
  Result result{.table = {{"missed gates", "-", std::to_string(misses)},
                          {"false positives", "-", std::to_string(failures.size() - misses)}},
                .json = {{"allowed_fp_per_image", kAllowedInSet},
                         {"missed", misses},
                         {"false_positives", failures.size() - misses}},
                .csv = "rank,set,image,kind,score,threshold,side_px,aspect,evidence_nats\n",
                .picture = drawing::Canvas(1, 1)};
  auto list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < failures.size(); ++i) {
    const Failure& f = failures[i];
    const char* kind = f.miss ? "missed" : "false";
    result.csv += std::to_string(i + 1) + "," + f.set + "," + f.image + "," + kind + "," +
                  (f.found ? files::text_of(f.score, 4) : "") + "," +
                  files::text_of(f.threshold, 4) + "," + files::text_of(f.side_px, 3) + "," +
                  files::text_of(f.aspect, 3) + "," + files::text_of(f.evidence, 3) + "\n";
    if (i >= kWorst) continue;
    result.table.push_back({f.set, "-",
                            f.image + " " + kind + ", side " + fixed(f.side_px, 0) + " px, score " +
                                fixed(f.score, 2) + " of " + fixed(f.threshold, 2)});
    list.push_back({{"set", f.set},
                    {"image", f.image},
                    {"kind", kind},
                    {"score", f.score},
                    {"threshold", f.threshold},
                    {"side_px", f.side_px},
                    {"aspect", f.aspect},
                    {"evidence_nats", f.evidence}});
  }
  result.json["worst"] = list;
  failures.resize(std::min(failures.size(), kWorst));
  result.picture = sheet(sets, failures);
  return result;
}

}  // namespace gatefly::experiments
