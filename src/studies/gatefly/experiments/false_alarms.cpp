// SPDX-License-Identifier: Apache-2.0
// What every shipped configuration takes for a gate where there is none: real pictures without
// gates, rendered halls nobody set one up in.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/experiments/robustness_pictures.hpp"
#include "gatefly/experiments/twin_pictures.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kAim = 0.02;  // false positives a picture [ours]
constexpr std::uint64_t kAlarmsReported = 3901,
                        kAlarmsLookedAt = 1001;  // first seeds: in full, quick
constexpr std::array kConfigs{"default", "cyberzoo", "basement", "flights", "washington"};
constexpr std::array kRealSets{"cyberzoo", "basement580"};
constexpr std::array kTracks{"exhibition", "showroom", "darkhall"};

/// Pictures without a gate, but for those nobody labelled.
struct Negatives {
  std::string name;
  std::vector<TwinPicture> pictures;
};

Negatives real_ones(const Options& options) {
  Negatives negatives{.name = "real", .pictures = {}};
  for (const char* set : kRealSets)
    for (TwinPicture& picture :
         real_pictures({.set = set, .config = {}, .track = {}, .settings = {}}, options))
      if (!picture.gate) negatives.pictures.push_back(std::move(picture));
  return negatives;
}

Negatives rendered_ones(const char* track, const Options& options) {
  const TwinRoom room{.set = {},
                      .config = {},
                      .track = track,
                      .recording = files::Recording::kJpeg,
                      .shake_deg = 4.0,
                      .settings = {}};
  const TwinOrder order{.first_seed = first_seed(options, kAlarmsReported, kAlarmsLookedAt),
                        .seeds = 17,
                        .per_seed = 10,
                        .without_gates = true};
  return {.name = std::string{"rendered "} + track,
          .pictures = rendered_pictures(room, order, options)};
}

int false_alarms_in(const Negatives& negatives, const config::Config& config) {
  const tuning::Judging judging{.detector = config.pilot.detector,
                                .lowest = config.pilot.detector.min_score};
  std::vector<double> wrong(negatives.pictures.size(), 0.0);
  in_parallel(wrong.size(), [&](std::size_t i) {
    const TwinPicture& picture = negatives.pictures[i];
    const tuning::LabelledImage image{
        .image = picture.view(),
        .truth = {.gates = {}, .ignored = picture.others, .detections = {}}};
    for (const tuning::Judged& found : tuning::judged_in(image, config.pilot.gate_color, judging))
      wrong[i] += found.wrong;
  });
  double sum = 0.0;
  for (const double count : wrong) sum += count;
  return static_cast<int>(std::lround(sum));
}

// Places of gates in other pictures, spread over the set: a filter might expect them.
std::vector<Quad> expectations(const Options& options) {
  constexpr std::size_t kApart = 15;
  std::vector<Quad> gates;
  std::size_t seen = 0;
  for (const TwinPicture& picture :
       real_pictures({.set = "cyberzoo", .config = {}, .track = {}, .settings = {}}, options))
    if (picture.gate && seen++ % kApart == 0) gates.push_back(*picture.gate);
  return gates;
}

/// In how many looks a gate is found where one is expected and none is; of all looks.
std::pair<int, int> expected_alarms_in(const Negatives& negatives, const std::vector<Quad>& gates,
                                       const config::Config& config) {
  std::vector<int> wrong(negatives.pictures.size(), 0);
  in_parallel(wrong.size(), [&](std::size_t i) {
    const TwinPicture& picture = negatives.pictures[i];
    GateDetector detector{config.pilot.detector};
    for (const Quad& gate : gates) {
      const GatesInView view = detector.look(
          picture.view(), config.pilot.gate_color,
          {.gates = LookFor::Gates::kStandingOut, .expected_bars = &gate, .quick = true});
      wrong[i] +=
          std::any_of(view.gates.begin(), view.gates.end(), [&](const GateDetection& found) {
            const auto is = [&](const Quad& other) { return same_place(found.corners_px, other); };
            return is(gate) && std::none_of(picture.others.begin(), picture.others.end(), is);
          });
    }
  });
  const int looks = static_cast<int>(negatives.pictures.size() * gates.size());
  return {std::accumulate(wrong.begin(), wrong.end(), 0), looks};
}

config::Config shipped(const std::string& name) {
  const std::vector<std::string> names{name};
  return config::load_config(config::config_files(names));
}

}  // namespace

Result false_alarms(const Options& options) {
  Result result{.table = {},
                .json = {{"aim_fp_per_image", kAim}},
                .csv = "pictures,config,count,false_alarms\n",
                .picture = drawing::Canvas(1, 1)};
  std::vector<std::string> rows;
  RowMarks aim{"aim", {}, drawing::kLight.ink, true},
      found{"found", {}, drawing::kLight.gate_solid};
  const auto add = [&](const Negatives& negatives) {
    for (const char* name : kConfigs) {
      if (options.stopped()) throw Stopped{};
      const int count = false_alarms_in(negatives, shipped(name));
      const auto pictures = negatives.pictures.size();
      const double rate = pictures > 0 ? count / static_cast<double>(pictures) : 0.0;
      rows.push_back(negatives.name + ", " + name);
      aim.values.push_back(kAim), found.values.push_back(rate);
      result.table.push_back({rows.back(), "-",
                              fixed(rate, 3) + " a picture, " + std::to_string(count) + " in " +
                                  std::to_string(pictures) + ", aim " + fixed(kAim, 2) +
                                  (rate <= kAim ? ": met" : ": missed")});
      result.json["counts"].push_back({{"pictures", negatives.name},
                                       {"config", name},
                                       {"count", pictures},
                                       {"false_alarms", count}});
      result.csv += negatives.name + "," + name + "," + std::to_string(pictures) + "," +
                    std::to_string(count) + "\n";
    }
  };
  const Negatives real = real_ones(options);
  add(real);
  const auto [alarms, looks] = expected_alarms_in(real, expectations(options), shipped("cyberzoo"));
  result.table.push_back({"real, cyberzoo, where one is expected", "-",
                          fixed(alarms / std::max(1.0, static_cast<double>(looks)), 4) +
                              " a look, " + std::to_string(alarms) + " in " +
                              std::to_string(looks)});
  result.json["expected"] = {{"looks", looks}, {"false_alarms", alarms}};
  for (std::size_t t = 0; t < kTracks.size(); ++t) {
    options.progress(static_cast<double>(1 + t) / (1 + kTracks.size()), kTracks[t]);
    add(rendered_ones(kTracks[t], options));
  }
  result.picture =
      draw_rows("False alarms a picture without a gate", rows, std::array{aim, found}, 0.1);
  return result;
}

}  // namespace gatefly::experiments
