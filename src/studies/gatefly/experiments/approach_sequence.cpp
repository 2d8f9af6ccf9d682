// SPDX-License-Identifier: Apache-2.0
// Li18's figure "sequence": while a gate is approached, in which pictures is it found?
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

struct Sequence {
  int first, last;  ///< Numbers in the pictures' names.
};
constexpr std::array<Sequence, 4> kSequences{{{111, 117}, {118, 123}, {133, 137}, {139, 145}}};
constexpr std::size_t kLongest = 7;

/// The number in "img_00111.jpg"; -1 where there is none.
int number_of(const std::string& image) {
  const auto at = image.find_first_of("0123456789");
  return at == std::string::npos ? -1 : std::atoi(image.c_str() + at);
}

/// One picture of a sequence and what was found in it.
struct Sighted {
  std::size_t sequence, place;  ///< Which, and how far along.
  std::size_t picture;          ///< In the set.
  double distance = 0.0;        ///< By the label's area [m]; NaN without a label.
  int paper_hits = 0;           ///< Hits of all repeats.
  bool flown_hit = false;
  std::vector<Quad> shown;  ///< Candidates of mode paper in the first repeat.
  bool shown_hit = false;
};

std::vector<Sighted> moments_of(const LabelledSet& set) {
  std::vector<Sighted> moments;
  for (std::size_t s = 0; s < kSequences.size(); ++s) {
    std::size_t place = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      const files::LabelledPicture& picture = set.labels.pictures[i];
      const int number = number_of(picture.image);
      if (number < kSequences[s].first || number > kSequences[s].last || place == kLongest)
        continue;
      const double distance = picture.gates.empty()
                                  ? std::nan("")
                                  : distance_from_area(files::polygon_area(picture.gates.front()));
      moments.push_back(
          {.sequence = s, .place = place++, .picture = i, .distance = distance, .shown = {}});
    }
  }
  return moments;
}

bool hit(const files::PictureToScore& picture) {
  return files::score({&picture, 1}, files::Rule::kOverlap70Authors).hits > 0;
}

void look(const LabelledSet& set, std::vector<Sighted>& moments, int repeats,
          const Options& options) {
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (options.stopped()) throw Stopped{};
    const auto pictures = run_paper(set, {}, repeat);
    for (Sighted& moment : moments) {
      const files::PictureToScore& picture = pictures[moment.picture];
      moment.paper_hits += hit(picture);
      if (repeat == 0) moment.shown = picture.detections, moment.shown_hit = hit(picture);
    }
  }
  in_parallel(moments.size(), [&](std::size_t i) {
    Rng rng{i};
    const auto gate = detect_as_flown(set.picture(moments[i].picture), {}, rng);
    files::PictureToScore picture{
        .gates = set.labels.pictures[moments[i].picture].gates, .ignored = {}, .detections = {}};
    if (gate) picture.detections.push_back(gate->corners_px);
    moments[i].flown_hit = hit(picture);
  });
}

/// A row for each sequence, from far to near: pictures, labels thin, candidates thick.
drawing::Canvas contact_sheet(const LabelledSet& set, const std::vector<Sighted>& moments) {
  constexpr int kGap = 10, kCaption = 40, kTop = 84;
  const int width = set.picture(moments.front().picture).width(),
            height = set.picture(moments.front().picture).height();
  drawing::Canvas sheet(static_cast<int>(kLongest) * (width + kGap) + kGap,
                        kTop + static_cast<int>(kSequences.size()) * (height + kCaption + kGap));
  sheet.text({kGap, 54.0},
             "The paper's detector while a gate is approached: label (dashed), found (cyan), found "
             "but no gate (pink)",
             {.size = 36.0, .bold = true});
  for (const Sighted& moment : moments) {
    const drawing::Box tile{
        .x = kGap + static_cast<double>(moment.place) * (width + kGap),
        .y = kTop + static_cast<double>(moment.sequence) * (height + kCaption + kGap),
        .width = static_cast<double>(width),
        .height = static_cast<double>(height)};
    const files::LabelledPicture& labelled = set.labels.pictures[moment.picture];
    sheet.clip(tile);
    sheet.image(set.picture(moment.picture), {tile.x, tile.y}, 1.0);
    const Eigen::Vector2d offset{tile.x + 0.5, tile.y + 0.5};
    for (const Quad& gate : labelled.gates) {
      const Quad at{offset + gate[0], offset + gate[1], offset + gate[2], offset + gate[3]};
      sheet.outline(at, {.color = drawing::kDark.ink, .width = 1.0, .dash = 3.0});
    }
    for (const Quad& quad : moment.shown) {
      const bool is_gate =
          std::any_of(labelled.gates.begin(), labelled.gates.end(), [&](const Quad& gate) {
            return files::matches(quad, gate, files::Rule::kOverlap70Authors);
          });
      drawing::draw_detection(
          sheet, {quad, 1.0}, {tile.x, tile.y}, 1.0,
          {.color = is_gate ? drawing::kDark.found : drawing::kDark.estimate, .width = 1.6});
    }
    sheet.unclip();
    sheet.text(
        {tile.x, tile.bottom() + 28.0},
        labelled.image + "  " +
            (std::isfinite(moment.distance) ? fixed(moment.distance, 1) + " m" : "no label") +
            (moment.shown_hit ? "  found" : ""),
        {.color = moment.shown_hit ? drawing::kLight.found : drawing::kLight.muted, .size = 24.0});
  }
  return sheet;
}

}  // namespace

Result approach_sequence(const Options& options) {
  const LabelledSet set(data_folder("tudelft_bebop_gates", options) / "basement32_hq");
  std::vector<Sighted> moments = moments_of(set);
  if (moments.empty())
    throw std::runtime_error(
        "basement32_hq/labels.csv: names no picture of img_00111 to img_00145");
  const int repeats = options.quick ? 2 : 10;
  look(set, moments, repeats, options);

  Result result{.table = {},
                .json = {},
                .csv = "image,distance_m,paper_mode_hits,repeats,flown_mode_hit\n",
                .picture = contact_sheet(set, moments)};
  auto list = nlohmann::ordered_json::array();
  for (const Sighted& moment : moments) {
    const std::string& image = set.labels.pictures[moment.picture].image;
    result.csv += image + "," +
                  (std::isfinite(moment.distance) ? files::text_of(moment.distance, 4) : "") + "," +
                  std::to_string(moment.paper_hits) + "," + std::to_string(repeats) + "," +
                  (moment.flown_hit ? "1" : "0") + "\n";
    list.push_back(
        {{"image", image},
         {"sequence", moment.sequence},
         {"distance_m",
          std::isfinite(moment.distance) ? nlohmann::ordered_json(moment.distance) : nullptr},
         {"paper_mode_hits", moment.paper_hits},
         {"flown_mode_hit", moment.flown_hit}});
  }
  for (std::size_t s = 0; s < kSequences.size(); ++s) {
    int labelled = 0, hits = 0, flown = 0;
    for (const Sighted& moment : moments)
      if (moment.sequence == s && std::isfinite(moment.distance))
        ++labelled, hits += moment.paper_hits, flown += moment.flown_hit;
    result.table.push_back(
        {"img " + std::to_string(kSequences[s].first) + "-" + std::to_string(kSequences[s].last),
         "picture only",
         fixed(static_cast<double>(hits) / repeats, 1) + " of " + std::to_string(labelled) +
             " (as flown: " + std::to_string(flown) + ")"});
  }
  result.json = {{"rule", "overlap70-authors"}, {"repeats", repeats}, {"pictures", list}};
  return result;
}

}  // namespace gatefly::experiments
