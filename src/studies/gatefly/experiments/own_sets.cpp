// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/own_sets.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace gatefly::experiments {
namespace {

struct Place {
  const char *name, *folder, *labels, *ignored, *config;
};
constexpr std::array<Place, 5> kPlaces{
    {{"basement32_hq", "tudelft_bebop_gates", "labels.csv", nullptr, "basement"},
     {"distance51", "tudelft_bebop_gates", "labels.csv", nullptr, "cyberzoo"},
     {"cyberzoo", "tudelft_bebop_gates", "labels.csv", nullptr, "cyberzoo"},
     {"basement580", "tudelft_bebop_gates", "labels.csv", "unlabelled_gates.csv", "basement"},
     {"washington_obrace", "", "corners.csv", nullptr, "washington"}}};

using Gates = std::map<std::string, std::vector<Quad>>;

/// The second gate of distance51, at the right: real, unlabelled, seen by eye; good to some pixels.
Gates second_gates() {
  const auto gate = [](double a, double b, double c, double d, double e, double f, double g,
                       double h) {
    return std::vector<Quad>{Quad{Eigen::Vector2d{a, b}, {c, d}, {e, f}, {g, h}}};
  };
  return {{"img_00002.jpg", gate(284, 31, 308, 46, 310, 87, 289, 80)},
          {"img_00003.jpg", gate(286, 27, 313, 45, 314, 88, 290, 78)},
          {"img_00004.jpg", gate(278, 22, 306, 38, 308, 82, 282, 72)},
          {"img_00005.jpg", gate(273, 19, 304, 36, 306, 81, 277, 71)},
          {"img_00006.jpg", gate(271, 16, 306, 34, 308, 81, 275, 70)},
          {"img_00007.jpg", gate(258, 12, 296, 30, 298, 78, 262, 67)},
          {"img_00008.jpg", gate(248, 7, 291, 26, 295, 77, 253, 65)},
          {"img_00009.jpg", gate(238, 3, 285, 22, 288, 75, 241, 63)},
          {"img_00010.jpg", gate(227, 1, 277, 19, 280, 73, 229, 61)}};
}

Gates ignored_of(const Place& place, const std::filesystem::path& folder) {
  if (std::string{place.name} == "distance51") return second_gates();
  Gates gates;
  if (place.ignored != nullptr)
    for (const files::LabelledPicture& picture :
         files::read_labels(folder / place.ignored).pictures)
      gates[picture.image] = picture.gates;
  return gates;
}

}  // namespace

int OwnSet::gates() const {
  return tuning::count_gates(first, judging.nearest) + tuning::count_gates(second, judging.nearest);
}

const std::vector<std::string>& own_set_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Place& place : kPlaces) list.emplace_back(place.name);
    return list;
  }();
  return names;
}

OwnSet own_set(const std::string& name, const Options& options) {
  const Place& place = *std::find_if(kPlaces.begin(), kPlaces.end() - 1,
                                     [&](const Place& p) { return name == p.name; });
  const std::string top = *place.folder != '\0' ? place.folder : place.name;
  std::filesystem::path folder = data_folder(top, options);
  if (*place.folder != '\0') folder /= place.name;
  const std::vector<std::string> configs{place.config};
  const config::Config config = config::load_config(config::config_files(configs));
  OwnSet set{.name = name,
             .files = LabelledSet(folder, place.labels, config.camera.stored_rotation_deg),
             .config = config,
             .first = {},
             .second = {},
             .names = {},
             .judging = {.detector = config.pilot.detector}};
  const bool is_washington = top == place.name;
  if (is_washington) set.judging.rule = files::Rule::kIou50, set.judging.nearest = true;
  set.judging.all = name == "distance51";  // two gates are in view
  // all gates are alike, so the nearest is the largest; nine pictures list it last
  if (is_washington)
    for (files::LabelledPicture& label : set.files.labels.pictures)
      std::stable_sort(label.gates.begin(), label.gates.end(), [](const Quad& a, const Quad& b) {
        return files::polygon_area(a) > files::polygon_area(b);
      });
  Gates ignored = ignored_of(place, folder);
  for (std::size_t i = 0; i < set.files.size(); ++i) {
    const files::LabelledPicture& label = set.files.labels.pictures[i];
    if (!label.first_identical.empty() && label.first_identical != label.image) continue;
    (2 * i < set.files.size() ? set.first : set.second)
        .push_back({set.files.picture(i),
                    {.gates = label.gates,
                     .ignored = ignored[label.image],
                     .detections = {},
                     .true_distance = label.true_distance}});
    set.names.push_back(label.image);
  }
  return set;
}

std::vector<tuning::Judged> judged_by_halves(const OwnSet& set, Colors colors, bool fast) {
  const auto learnt = [&](tuning::Pictures half) {
    const ColorModel& described = set.config.pilot.gate_color;
    if (colors == Colors::kDescribed) return described;
    return colors == Colors::kLabels
               ? tuning::fit_to_labels(half, described, set.config.pilot.detector)
               : tuning::train_on_own(half, described, set.config.pilot.detector).color;
  };
  std::array<ColorModel, 2> models;
  in_parallel(2, [&](std::size_t i) { models[i] = learnt(i == 0 ? set.second : set.first); });
  tuning::Judging judging =
      colors == Colors::kDescribed ? set.judging : tuning::with_fitted_colors(set.judging);
  judging.fast = fast;
  std::vector<std::vector<tuning::Judged>> by_picture(set.size());
  in_parallel(set.size(), [&](std::size_t i) {
    by_picture[i] =
        tuning::judged_in(set.picture(i), models[i < set.first.size() ? 0 : 1], judging);
    for (tuning::Judged& found : by_picture[i]) found.picture = i;
  });
  std::vector<tuning::Judged> all;
  for (const auto& list : by_picture) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace gatefly::experiments
