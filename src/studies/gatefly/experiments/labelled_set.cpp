// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/labelled_set.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "gatefly/files/text.hpp"

namespace gatefly::experiments {

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto worker = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock{mutex};
      if (!error) error = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) others.emplace_back(worker);
    worker();
  }
  if (error) std::rethrow_exception(error);
}

LabelledSet::LabelledSet(const std::filesystem::path& folder, const std::string& labels_file,
                         int rotation_deg)
    : labels{files::read_labels(folder / labels_file)}, stored_rotation_deg{rotation_deg} {
  std::stable_sort(
      labels.pictures.begin(), labels.pictures.end(),
      [](const auto& a, const auto& b) { return files::counts_before(a.image, b.image); });
  for (const files::LabelledPicture& picture : labels.pictures)
    files.push_back(files::read_image(folder / picture.image));
}

std::vector<std::vector<Quad>> unlabelled_gates(const LabelledSet& set,
                                                const std::filesystem::path& file) {
  std::map<std::string, std::vector<Quad>> by_name;
  for (const files::LabelledPicture& picture : files::read_labels(file).pictures)
    by_name[picture.image] = picture.gates;
  std::vector<std::vector<Quad>> gates;
  for (const files::LabelledPicture& picture : set.labels.pictures)
    gates.push_back(by_name[picture.image]);
  return gates;
}

PaperDetector as_paper(const PaperDetectorParams& params) {
  return [params](const Image& image, Rng& rng) {
    const PaperDetections found = detect_as_paper(image, params, rng);
    return std::vector<GateDetection>(found.begin(), found.end());
  };
}

PaperDetector as_paper_best(const PaperDetectorParams& params) {
  PaperDetectorParams all = params;
  all.same_gate = 2.0;  // of two candidates on one gate the fitter counts, not the first
  return [all](const Image& image, Rng& rng) {
    const PaperDetections found = detect_as_paper(image, all, rng);
    const auto best =
        std::max_element(found.begin(), found.end(),
                         [](const auto& a, const auto& b) { return a.fitness < b.fitness; });
    return best == found.end() ? std::vector<GateDetection>{} : std::vector<GateDetection>{*best};
  };
}

PaperDetector as_flown() {
  return [](const Image& image, Rng& rng) {
    const auto gate = detect_as_flown(image, {}, rng);
    return gate ? std::vector<GateDetection>{*gate} : std::vector<GateDetection>{};
  };
}

Found run(const LabelledSet& set, const PaperDetector& detector, int repeat) {
  Found found(set.size());
  in_parallel(set.size(), [&](std::size_t i) {
    Rng rng{1'000'003u * static_cast<std::uint64_t>(repeat) + i};
    found[i] = detector(set.picture(i), rng);
  });
  return found;
}

std::vector<files::PictureToScore> to_score(const LabelledSet& set, const Found& found) {
  std::vector<files::PictureToScore> pictures(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) {
    pictures[i].gates = set.labels.pictures[i].gates;
    for (const GateDetection& gate : found[i]) pictures[i].detections.push_back(gate.corners_px);
  }
  return pictures;
}

std::vector<files::PictureToScore> run_paper(const LabelledSet& set,
                                             const PaperDetectorParams& params, int repeat) {
  return to_score(set, run(set, as_paper(params), repeat));
}

RocPoint roc_point(const LabelledSet& set, const PaperDetector& detector, int repeats,
                   const Options& options) {
  RocPoint point;
  double squares = 0.0;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (options.stopped()) throw Stopped{};
    const files::Score score =
        files::score(to_score(set, run(set, detector, repeat)), files::Rule::kOverlap70Authors);
    const double tpr = score.true_positive_rate();
    point.tpr += tpr / repeats, squares += tpr * tpr / repeats;
    point.fp_per_image += score.false_positives_per_image() / repeats;
  }
  point.tpr_std = std::sqrt(std::max(0.0, squares - point.tpr * point.tpr));
  return point;
}

RocPoint roc_point(const LabelledSet& set, const PaperDetectorParams& params, int repeats,
                   const Options& options) {
  RocPoint point = roc_point(set, as_paper(params), repeats, options);
  point.min_side_px = params.min_side_px, point.min_color_fitness = params.min_color_fitness;
  return point;
}

double distance_from_area(double area_px2) {
  // px², m: read off the authors' curve, a straight line between two of its points. It ends at 6000
  // px²; nearer, the size in the picture goes with 1 / distance.
  constexpr std::array<std::pair<double, double>, 8> kCurve{{{100, 8.0},
                                                             {300, 7.2},
                                                             {600, 6.2},
                                                             {1000, 5.2},
                                                             {1500, 4.3},
                                                             {2500, 3.35},
                                                             {4000, 2.6},
                                                             {6000, 1.9}}};
  if (area_px2 > kCurve.back().first)
    return kCurve.back().second * std::sqrt(kCurve.back().first / area_px2);
  std::size_t i = 1;
  while (i + 1 < kCurve.size() && area_px2 > kCurve[i].first) ++i;
  const auto [near_area, near] = kCurve[i];
  const auto [far_area, far] = kCurve[i - 1];
  return far + (area_px2 - far_area) / (near_area - far_area) * (near - far);
}

}  // namespace gatefly::experiments
