// SPDX-License-Identifier: Apache-2.0
// Our detector on pictures that were changed: other cameras, light, motion, what stands beside or
// before a gate.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "gatefly/experiments/changed_set.hpp"
#include "gatefly/experiments/robustness_pictures.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kAllowed = 0.05;  // false positives a picture
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// True positive rates that are aimed at on the Cyberzoo's pictures. [ours]
struct Aim {
  std::string_view key;
  double true_positive_rate;
};
constexpr std::array<Aim, 16> kAims{{{"jpeg50-420", 0.90},
                                     {"jpeg20-420", 0.80},
                                     {"blur-2", 0.88},
                                     {"bright-0.5", 0.88},
                                     {"bright-0.25", 0.55},
                                     {"saturation-0.3", 0.70},
                                     {"white-bluer", 0.88},
                                     {"white-redder", 0.88},
                                     {"motion-9", 0.85},
                                     {"motion-9-down", 0.85},
                                     {"motion-15", 0.55},
                                     {"band-top", 0.88},
                                     {"band-right", 0.88},
                                     {"band-bottom", 0.88},
                                     {"band-left", 0.88},
                                     {"second-gate", 0.90}}};

double aim_of(std::string_view key) {
  const auto* aim =
      std::find_if(kAims.begin(), kAims.end(), [&](const Aim& a) { return a.key == key; });
  return aim == kAims.end() ? kNone : aim->true_positive_rate;
}

/// A way to choose colours and threshold.
struct Choice {
  const char* key;
  ChangedRate ChangedRates::*rate;
  bool tunes = false;
};
constexpr std::array<Choice, 4> kChoices{{{"shipped", &ChangedRates::shipped},
                                          {"other_half", &ChangedRates::other_half},
                                          {"self_tuned", &ChangedRates::self_tuned, true},
                                          {"best", &ChangedRates::best}}};

struct Place {
  const char* set;
  bool tunes;  ///< Also with colours of its own; one of 32 pictures has too few for that.
  bool has_aims;
};
constexpr std::array<Place, 2> kPlaces{{{"cyberzoo", true, true}, {"basement32_hq", false, false}}};

bool met(const ChangedRate& rate, double aim) {
  constexpr double kRounding = 1e-9;
  return rate.true_positive_rate >= aim - kRounding && rate.false_per_image <= kAllowed + kRounding;
}

std::string row_text(const ChangedRates& rates, bool tunes, double aim) {
  std::string text;
  for (const Choice& choice : kChoices) {
    if ((choice.tunes && !tunes) || choice.rate == &ChangedRates::best) continue;
    const ChangedRate& rate = rates.*choice.rate;
    text += (text.empty() ? "" : "  ") + fixed(rate.true_positive_rate, 3) + " at " +
            fixed(rate.false_per_image, 3);
    if (std::isfinite(aim)) text += met(rate, aim) ? " met   " : " missed";
  }
  return text;
}

nlohmann::ordered_json json_of(const PictureChange& change, const ChangedRates& rates, bool tunes,
                               double aim) {
  nlohmann::ordered_json json{{"change", change.key},
                              {"what", change.words},
                              {"pictures", rates.pictures},
                              {"gates", rates.gates},
                              {"aim", number(aim)}};
  for (const Choice& choice : kChoices) {
    if (choice.tunes && !tunes) continue;
    const ChangedRate& rate = rates.*choice.rate;
    json[choice.key] = {{"tpr", rate.true_positive_rate},
                        {"fp_per_image", rate.false_per_image},
                        {"min_score", rate.min_scores}};
    if (std::isfinite(aim)) json[choice.key]["met"] = met(rate, aim);
  }
  return json;
}

std::string csv_of(const std::string& set, const PictureChange& change, const ChangedRates& rates,
                   bool tunes) {
  std::string csv;
  for (const Choice& choice : kChoices) {
    if (choice.tunes && !tunes) continue;
    const ChangedRate& rate = rates.*choice.rate;
    csv += set + "," + change.key + "," + choice.key;
    for (const double value :
         {rate.true_positive_rate, rate.false_per_image, rate.min_scores[0], rate.min_scores[1]})
      csv += "," + files::text_of(value, 6);
    csv += "\n";
  }
  return csv;
}

/// Whole gate of the middle size that leaves room for a second one.
const UprightPicture* example_of(const UprightHalves& halves) {
  std::vector<const UprightPicture*> list;
  const PictureChange& roomy = picture_changes().back();
  for (const auto& half : halves)
    for (const UprightPicture& picture : half)
      if (!picture.gates.empty() && roomy.apply(picture)) list.push_back(&picture);
  if (list.empty()) return nullptr;
  const auto size = [](const UprightPicture* p) { return files::polygon_area(p->gates.front()); };
  const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
  std::nth_element(list.begin(), middle, list.end(),
                   [&](const auto* a, const auto* b) { return size(a) < size(b); });
  return *middle;
}

/// Points of one set in the plot.
struct Drawn {
  std::vector<std::string> rows = {};
  std::array<RowMarks, 4> marks{{{"aim", {}, drawing::kLight.ink, true},
                                 {"shipped", {}, drawing::kLight.gate_solid},
                                 {"threshold of the other half", {}, drawing::kLight.found},
                                 {"colours, too", {}, drawing::kLight.flown}}};

  void add(const PictureChange& change, const ChangedRates& rates, double aim, bool tunes) {
    rows.emplace_back(change.words);
    const std::array values{aim, rates.shipped.true_positive_rate,
                            rates.other_half.true_positive_rate,
                            tunes ? rates.self_tuned.true_positive_rate : kNone};
    for (std::size_t i = 0; i < marks.size(); ++i) marks[i].values.push_back(values[i]);
  }
};

/// One set's changes, row by row, into the result and the plot.
void add_set(const Place& place, const Options& options, Result& result, Drawn& drawn) {
  const OwnSet set = own_set(place.set, options);
  const UprightHalves halves = upright_halves(set);
  const bool tunes = place.tunes && !options.quick;
  auto list = nlohmann::ordered_json::array();
  result.table.push_back(
      {set.name + ", " + std::to_string(set.size()) + " pictures", "-",
       std::string{"shipped | threshold of the other half"} + (tunes ? " | colours, too" : "")});
  const auto changes = picture_changes();
  const auto first = static_cast<double>(&place - kPlaces.data());
  for (const PictureChange& change : changes) {
    if (options.stopped()) throw Stopped{};
    const double part = static_cast<double>(list.size()) / static_cast<double>(changes.size());
    options.progress((first + part) / static_cast<double>(kPlaces.size()),
                     set.name + ", " + change.words);
    const double aim = place.has_aims ? aim_of(change.key) : kNone;
    const ChangedRates rates =
        rates_of(changed_set(halves, change), set, change.every_gate, kAllowed, tunes);
    const std::string aimed = std::isfinite(aim) ? ", aim " + fixed(aim, 2) : "";
    result.table.push_back({"  " + (change.words + aimed), "-", row_text(rates, tunes, aim)});
    list.push_back(json_of(change, rates, tunes, aim));
    result.csv += csv_of(set.name, change, rates, tunes);
    if (place.has_aims) drawn.add(change, rates, aim, tunes);
  }
  result.json["sets"].push_back({{"set", set.name}, {"changes", list}});
  if (const UprightPicture* example = place.has_aims ? example_of(halves) : nullptr)
    result.extra.push_back({"changes", sheet_of_changes(*example, set)});
}

}  // namespace

Result robustness(const Options& options) {
  Result result{.table = {},
                .json = {{"rule", "overlap70"}, {"allowed_fp_per_image", kAllowed}},
                .csv = "set,change,choice,tpr,fp_per_image,min_score_first,min_score_second\n",
                .picture = drawing::Canvas(1, 1)};
  Drawn drawn;
  for (const Place& place : kPlaces) add_set(place, options, result, drawn);
  result.picture =
      draw_rows("Gates found in changed pictures of the Cyberzoo", drawn.rows, drawn.marks);
  return result;
}

}  // namespace gatefly::experiments
