// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gatefly/detection/paper/paper_detector.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {

/// Calls work(i) for every i below `count` on all cores. What it writes must belong to its i alone;
/// the first exception ends all and comes out here.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// Every row of a labels.csv with its picture, decoded.
struct LabelledSet {
  files::Labels labels;
  std::vector<files::ImageFile> files;  ///< One for each of labels.pictures.
  int stored_rotation_deg = 90;         ///< As the Bebop stores them.

  /// Pictures in the order of their numbers.
  /// @throws std::runtime_error one line: a file is missing or wrong.
  explicit LabelledSet(const std::filesystem::path& folder,
                       const std::string& labels_file = "labels.csv", int rotation_deg = 90);
  [[nodiscard]] std::size_t size() const { return files.size(); }
  [[nodiscard]] Image picture(std::size_t i) const { return files[i].view(stored_rotation_deg); }
};

/// Gates that are there and have no label, by picture of the set.
/// @throws std::runtime_error one line: the file is missing or wrong.
[[nodiscard]] std::vector<std::vector<Quad>> unlabelled_gates(const LabelledSet& set,
                                                              const std::filesystem::path& file);

/// Everything that a detector of the paper's finds in one picture.
using PaperDetector = std::function<std::vector<GateDetection>(const Image& image, Rng& rng)>;

/// Mode `paper`, every candidate.
[[nodiscard]] PaperDetector as_paper(const PaperDetectorParams& params = {});
/// Mode `paper`, the candidate with the highest colour fitness: the race of 2017's rule. Li18 §3.1.
[[nodiscard]] PaperDetector as_paper_best(const PaperDetectorParams& params = {});
/// Mode `flown`, picture by picture.
[[nodiscard]] PaperDetector as_flown();

/// Detections in each picture of a set by one run; the repeat's number seeds it. Same numbers,
/// same answer.
using Found = std::vector<std::vector<GateDetection>>;
[[nodiscard]] Found run(const LabelledSet& set, const PaperDetector& detector, int repeat);

/// The same beside the labels.
[[nodiscard]] std::vector<files::PictureToScore> to_score(const LabelledSet& set,
                                                          const Found& found);
[[nodiscard]] std::vector<files::PictureToScore> run_paper(const LabelledSet& set,
                                                           const PaperDetectorParams& params,
                                                           int repeat);

/// Hits and false positives of several runs, counted as the authors did.
struct RocPoint {
  double min_side_px = 0.0, min_color_fitness = 0.0;
  double tpr = 0.0, tpr_std = 0.0;  ///< Mean and standard deviation over the runs.
  double fp_per_image = 0.0;
};
[[nodiscard]] RocPoint roc_point(const LabelledSet& set, const PaperDetector& detector, int repeats,
                                 const Options& options);
[[nodiscard]] RocPoint roc_point(const LabelledSet& set, const PaperDetectorParams& params,
                                 int repeats, const Options& options);

/// Distance to a 1 m gate from its labelled area, as the authors' analysis has it [m].
[[nodiscard]] double distance_from_area(double area_px2);

}  // namespace gatefly::experiments
