// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "gatefly/files/text.hpp"

#include "fit.hpp"

namespace gatefly::measuring {
namespace {

constexpr std::size_t kEnough = 20;  // real gates in a bin: as the comparison with reality asks

sim::Finds finds_of(const std::vector<Look>& looks, const sim::Quantiles& fitness) {
  const auto own = fitness_of(looks);
  return {.rate = rate_of(looks),
          .staying = staying_of(looks, Share::kEachItsOwn),
          .fitness = own.size() >= kEnough ? quantiles_of(own) : fitness};
}

/// Rate and fitness by apparent size: real ones where there are enough.
std::array<sim::SizeBin, kSizes.size()> bins_of(const std::vector<Look>& rendered,
                                                const std::vector<Look>& real) {
  std::array<sim::SizeBin, kSizes.size()> bins;
  for (std::size_t bin = 0; bin < kSizes.size(); ++bin) {
    const auto there = in_bin(real, bin), drawn = in_bin(rendered, bin);
    const auto& looks = there.size() >= kEnough ? there : drawn;
    auto fitness = fitness_of(looks);
    if (fitness.size() < kEnough) fitness = fitness_of(rendered);
    // without a look: as the next smaller ones
    const double rate = looks.empty() && bin > 0 ? bins[bin - 1].rate : rate_of(looks);
    bins[bin] = {kSizes[bin], rate, quantiles_of(fitness)};
  }
  return bins;
}

std::vector<double> errors_of(const std::vector<Look>& looks, bool bars) {
  std::vector<double> errors;
  for (const Look& look : looks) {
    if (!look.hit) continue;
    for (const std::size_t i :
         bars ? std::array<std::size_t, 2>{0, 1} : std::array<std::size_t, 2>{2, 3})
      for (int axis = 0; axis < (bars ? 1 : 2); ++axis)
        errors.push_back(look.seen[i][axis] - look.truth[i][axis]);
  }
  return errors;
}

double sigma_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto quartiles = quantiles_of(std::move(values));
  return (quartiles[7] - quartiles[3]) / 1.0488;  // 30 and 70 %: ±0.5244 sigma
}

sim::Parts parts_of(const std::vector<Look>& looks, const std::vector<Look>& wrong, bool bars) {
  return {.rate = rate_of(looks),
          .staying = staying_of(looks, Share::kAll),
          .sigma_px = sigma_of(errors_of(looks, bars)),
          .false_rate = rate_of(wrong),
          .false_staying = staying_of(wrong, Share::kEachItsOwn)};
}

sim::Cuts cuts_of(const std::vector<Look>& looks, const std::vector<Look>& wrong) {
  constexpr std::array<double, 3> kCutSizes{160.0, 300.0, 1e9};  // [px]
  constexpr std::size_t kFewCuts = 12;
  sim::Cuts cuts{.staying = staying_of(looks, Share::kEachItsOwn),
                 .false_rate = rate_of(wrong),
                 .false_staying = staying_of(wrong, Share::kEachItsOwn)};
  for (std::size_t kind = 0; kind < cuts.kinds.size(); ++kind) {
    std::vector<Look> of_kind;
    for (const Look& look : looks)
      if (sim::cut_kind(look.in_view) == static_cast<sim::CutKind>(kind)) of_kind.push_back(look);
    double from = 0.0;
    for (std::size_t bin = 0; bin < kCutSizes.size(); ++bin) {
      std::vector<Look> there;
      for (const Look& look : of_kind)
        if (look.side_px >= from && look.side_px < kCutSizes[bin]) there.push_back(look);
      from = kCutSizes[bin];
      if (there.size() < kFewCuts) there = of_kind;
      std::vector<double> errors;
      for (const Look& look : there)
        for (std::size_t i = 0; look.hit && i < 4; ++i)
          for (int axis = 0; look.in_view[i] && axis < 2; ++axis)
            errors.push_back(look.seen[i][axis] - look.truth[i][axis]);
      cuts.kinds[kind][bin] = {kCutSizes[bin], rate_of(there), sigma_of(errors)};
    }
  }
  return cuts;
}

double per_picture(const Looks& looks) {
  return looks.pictures > 0 ? static_cast<double>(looks.alarms.size()) / looks.pictures : 0.0;
}

std::string text(double value) { return files::text_of(value, 4); }

std::string text(const sim::Quantiles& q) {
  std::string list = "{";
  for (std::size_t i = 0; i < q.size(); ++i) list += (i ? ", " : "") + text(q[i]);
  return list + "}";
}

std::string text(const sim::Staying& s) {
  return "{.seed = " + text(s.seed) + ", .row = " + text(s.row) + ", .time = " + text(s.time) + "}";
}

std::string text(const sim::Finds& a) {
  return "{.rate = " + text(a.rate) + ", .staying = " + text(a.staying) + ", .fitness = {" +
         text(a.fitness) + "}}";
}

std::string text(const sim::Parts& p) {
  return "{.rate = " + text(p.rate) + ", .staying = " + text(p.staying) +
         ", .sigma_px = " + text(p.sigma_px) + ", .false_rate = " + text(p.false_rate) +
         ", .false_staying = " + text(p.false_staying) + "}";
}

std::string text(const std::array<sim::SizeBin, kSizes.size()>& bins) {
  std::string list;
  for (const sim::SizeBin& bin : bins)
    list += "{.below_px = " + text(bin.below_px) + ", .rate = " + text(bin.rate) +
            ", .fitness = {" + text(bin.fitness) + "}},\n";
  return "{{" + list + "}}";
}

std::string text_if_any(const sim::Cuts& cuts) {
  if (cuts.kinds[0][0].below_px == 0.0) return "";
  std::string kinds;
  for (const sim::CutBins& bins : cuts.kinds) {
    kinds += "{{";
    for (const sim::CutBin& bin : bins)
      kinds += "{.below_px = " + text(bin.below_px) + ", .rate = " + text(bin.rate) +
               ", .sigma_px = " + text(bin.sigma_px) + "},";
    kinds += "}},\n";
  }
  return ",\n.cuts = {.kinds = {{" + kinds + "}}, .staying = " + text(cuts.staying) +
         ", .false_rate = " + text(cuts.false_rate) +
         ", .false_staying = " + text(cuts.false_staying) + "}";
}

std::string text(const sim::DetectorStatistics& s) {
  const sim::CornerErrors& c = s.corners;
  std::string told;
  for (const double each : s.told) told += (told.empty() ? "" : ", ") + text(each);
  return "{\n.gates = " + text(s.gates) + ",\n.others = " + text(s.others) +
         ",\n.aslant = " + text(s.aslant) + ",\n.hidden = " + text(s.hidden) +
         ",\n.staying = " + text(s.staying) + ",\n.corners = {.together = " + text(c.together) +
         ", .size = " + text(c.size) + ", .own = " + text(c.own) + ", .stays = " + text(c.stays) +
         ", .time = " + text(c.time) + ", .outlier_rate = " + text(c.outlier_rate) +
         ", .outlier_low = " + text(c.outlier_low) + ", .outlier_high = " + text(c.outlier_high) +
         "},\n.crooked = " + text(s.crooked) + ",\n.crooked_low = " + text(s.crooked_low) +
         ",\n.crooked_high = " + text(s.crooked_high) + ",\n.two_gates = " + text(s.two_gates) +
         ",\n.decoys = " + text(s.decoys) + ",\n.places = " + text(s.places) +
         ",\n.alarm_side_px = {" + text(s.alarm_side_px) + "}" + text_if_any(s.cuts) +
         ",\n.lower = " + text(s.lower) + ",\n.bars = " + text(s.bars) + ",\n.told = {" + told +
         "}\n}";
}

void print_line(const char* what, const std::vector<Look>& looks) {
  if (looks.empty()) return;
  std::printf("  %-38s %6zu  %.4f  ", what, looks.size(), rate_of(looks));
  for (const int lag : {1, 3, 8}) {
    const auto r = correlation(looks, lag);
    if (r)
      std::printf(" %.2f", *r);
    else
      std::printf("    -");
  }
  const auto of_seeds = correlation_of_seeds(looks, Share::kAll);
  if (of_seeds)
    std::printf("  %.2f", *of_seeds);
  else
    std::printf("     -");
  const auto fitness = quantiles_of(fitness_of(looks));
  std::printf("   %.2f %.2f %.2f\n", fitness[1], fitness[5], fitness[9]);
}

/// Of each field of a detection.
std::array<double, sim::kFields.size()> told_of(const Looks& looks) {
  std::array<double, sim::kFields.size()> told{};
  for (std::size_t field = 0; field < told.size(); ++field) {
    std::vector<double> gates, others;
    for (const sim::Fields& f : looks.of_gates) gates.push_back(f[field]);
    for (const sim::Fields& f : looks.of_others) others.push_back(f[field]);
    told[field] = sim::told_apart(gates, others);
  }
  return told;
}

/// How a seed's light goes with how much is found in it.
void print_light(const Looks& looks) {
  std::map<int, std::pair<double, double>> expected_and_found;
  std::array<double, kSizes.size()> rates{};
  for (std::size_t bin = 0; bin < kSizes.size(); ++bin)
    rates[bin] = rate_of(in_bin(looks[Kind::kGate], bin));
  for (const Look& look : looks[Kind::kGate]) {
    auto& [expected, found] = expected_and_found[look.seed];
    expected += rates[bin_of(look.side_px)], found += look.hit;
  }
  const auto table = [&](const char* what, const auto& value_of) {
    std::vector<std::pair<double, int>> order;
    for (const auto& [seed, sums] : expected_and_found)
      order.emplace_back(value_of(looks.lights.at(seed)), seed);
    std::sort(order.begin(), order.end());
    if (order.size() < 12) return;
    std::printf("  found / expected by %s:", what);
    for (std::size_t third = 0; third < 4; ++third) {
      double expected = 0.0, found = 0.0;
      const std::size_t from = third * order.size() / 4, to = (third + 1) * order.size() / 4;
      for (std::size_t i = from; i < to; ++i) {
        expected += expected_and_found[order[i].second].first;
        found += expected_and_found[order[i].second].second;
      }
      std::printf("  [%+.2f..%+.2f] %.3f", order[from].first, order[to - 1].first,
                  expected > 0.0 ? found / expected : 0.0);
    }
    std::printf("\n");
  };
  table("hue [rad]", [](const SeedLight& light) { return light.hue; });
  table("log brightness", [](const SeedLight& light) { return light.brightness; });
  table("log exposure", [](const SeedLight& light) { return light.exposure; });
}

}  // namespace

sim::DetectorStatistics fitted(const Looks& rendered, const Looks& real) {
  sim::DetectorStatistics s;
  s.gates = bins_of(rendered[Kind::kGate], real[Kind::kGate]);
  s.others = bins_of(rendered[Kind::kOther], {});
  s.staying = staying_of(rendered[Kind::kGate], Share::kAll);
  s.corners = corner_errors_of(rendered[Kind::kGate]);

  std::vector<double> alarm_fitness, sides, off;
  for (const Looks* looks : {&rendered, &real})
    for (const Alarm& alarm : looks->alarms)
      alarm_fitness.push_back(alarm.fitness), sides.push_back(alarm.side_px);
  for (const Look& look : rendered[Kind::kDecoy])
    if (look.hit) alarm_fitness.push_back(look.fitness), sides.push_back(side_of(look.seen));
  for (const Look& look : rendered[Kind::kCrooked])
    if (look.hit) off.push_back(std::min(1.0, largest_move(look.seen, look.truth) / look.side_px));
  s.alarm_side_px = quantiles_of(sides);
  const auto of_alarms = quantiles_of(alarm_fitness);
  const auto of_gates = quantiles_of(fitness_of(rendered[Kind::kGate]));
  s.aslant = finds_of(rendered[Kind::kAslant], of_gates);
  s.hidden = finds_of(rendered[Kind::kHidden], of_gates);
  s.crooked = finds_of(rendered[Kind::kCrooked], of_alarms);
  // real labels are of whole gates only: the others' wrong frames are rendered
  s.crooked.rate = std::max(s.crooked.rate, rate_of(real[Kind::kCrooked]));
  const auto moves = quantiles_of(off);
  s.crooked_low = moves[1], s.crooked_high = moves[9];
  s.two_gates = finds_of(rendered[Kind::kTwoGates], of_alarms);
  s.decoys = finds_of(rendered[Kind::kDecoy], of_alarms);
  const double in_view = static_cast<double>(rendered[Kind::kPlace].size()) / rendered.pictures;
  const double alarms = real.pictures > 0 ? per_picture(real) : per_picture(rendered);
  s.places = {.rate = alarms / in_view,
              .staying = staying_of(rendered.alarms, per_picture(rendered) / in_view),
              .fitness = of_alarms};
  s.told = told_of(rendered);
  s.lower = parts_of(rendered[Kind::kLower], rendered[Kind::kFalseLower], false);
  s.bars = parts_of(rendered[Kind::kBars], rendered[Kind::kFalseBars], true);
  s.cuts = cuts_of(rendered[Kind::kCut], rendered[Kind::kFalseCut]);
  return s;
}

void print(const std::string& title, const Looks& looks) {
  std::printf("\n%s: %d pictures, %.4f alarms at no known thing a picture\n", title.c_str(),
              looks.pictures, per_picture(looks));
  std::printf("  %-38s %6s  %s\n", "", "looks",
              "rate     correlation 1, 3, 8 pictures on, another hour   fitness 10 50 90 %");
  for (std::size_t bin = 0; bin < kSizes.size(); ++bin) {
    char what[60];
    std::snprintf(what, sizeof what, "whole gates of %.0f to %.0f px",
                  bin > 0 ? kSizes[bin - 1] : 20.0, std::min(kSizes[bin], 999.0));
    print_line(what, in_bin(looks[Kind::kGate], bin));
    print_line("  beside the largest", in_bin(looks[Kind::kOther], bin));
  }
  for (std::size_t kind = 0; kind < kKinds; ++kind)
    print_line(name_of(static_cast<Kind>(kind)), looks.of[kind]);
  std::vector<double> fitness, sides;
  for (const Alarm& alarm : looks.alarms)
    fitness.push_back(alarm.fitness), sides.push_back(alarm.side_px);
  const auto f = quantiles_of(fitness), s = quantiles_of(sides);
  std::printf("  other alarms: fitness %.2f %.2f %.2f, side %.0f %.0f %.0f px (10, 50, 90 %%)\n",
              f[1], f[5], f[9], s[1], s[5], s[9]);
  const auto c = corner_errors_of(looks[Kind::kGate]);
  std::printf(
      "  corners: together %.2f, size %.2f, each %.2f px; stays %.2f for %.2f s; outliers "
      "%.4f, %.1f to %.1f px\n",
      c.together, c.size, c.own, c.stays, c.time, c.outlier_rate, c.outlier_low, c.outlier_high);
  const auto told = told_of(looks);
  std::printf("  best threshold tells %zu gates from %zu false alarms by", looks.of_gates.size(),
              looks.of_others.size());
  for (std::size_t i = 0; i < told.size(); ++i) std::printf(" %s %.2f", sim::kFields[i], told[i]);
  std::printf("\n");
  print_light(looks);
}

void print(const std::string& title, const sim::DetectorStatistics& s) {
  std::printf("\n%s = %s\n", title.c_str(), text(s).c_str());
}

std::string header_of(const std::vector<NamedTable>& tables, const std::string& measured_on) {
  std::string text_of_tables;
  for (const NamedTable& table : tables)
    text_of_tables +=
        "inline const DetectorStatistics " + table.name + text(table.statistics) + ";\n\n";
  return "// SPDX-License-Identifier: Apache-2.0\n// Written by "
         "tools/detector_statistics/renew.sh: "
         "do not edit. Measured on " +
         measured_on +
         ".\n#pragma once\n\n#include \"gatefly/sim/detector_statistics.hpp\"\n\nnamespace "
         "gatefly::sim {\n\n" +
         text_of_tables + "}  // namespace gatefly::sim\n";
}

}  // namespace gatefly::measuring
