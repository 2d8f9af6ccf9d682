// SPDX-License-Identifier: Apache-2.0
// Where blind half circles end: the paper's, those in recorded takes, and simulated ones. Li18 §4,
// Fig. "feed forward control", Table "accuracy distribution".
#include <cmath>
#include <string>
#include <vector>

#include "gatefly/experiments/arc_picture.hpp"
#include "gatefly/experiments/arc_table.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/recorded_arcs.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr PlannedArc kPlanned;

/// What is known of the paper's arcs: read off its figure, checked against its table
/// (docs/paper/deviations.md#table-2) [m].
struct PaperArcs {
  std::size_t count = 17;
  Eigen::Vector2d mean{-0.33, 3.67}, variance{0.0251, 0.0657};
  Eigen::Vector2d entry_deviation{0.123, 0.078}, exit_deviation{0.201, 0.299};
  Eigen::Vector2d printed_variance{0.0296, 0.8087};  ///< Its table's "position error variance".
};

void report_paper(const PaperArcs& paper, Result& result) {
  Eigen::Vector2d with;
  for (int axis = 0; axis < 2; ++axis)
    with[axis] = variance_with_zero_row(paper.count, paper.mean[axis], paper.variance[axis]);
  result.table.push_back(
      {"variance of y, with a row of zeros left in [m²]", fixed(paper.printed_variance.y(), 4),
       fixed(with.y(), 4) + " from the paper's 17 arcs (x: " +
           fixed(paper.printed_variance.x(), 4) + ", " + fixed(with.x(), 4) + ")"});
  result.table.push_back({"  and without it", "",
                          fixed(paper.variance.y(), 4) + " m²: std " +
                              fixed(std::sqrt(paper.variance.y()), 2) + " m about " +
                              fixed(paper.mean.y(), 2) + " m"});
  result.json["paper"] = {{"arcs", paper.count},
                          {"displacement_m", json_of(paper.mean)},
                          {"variance_m2", json_of(paper.variance)},
                          {"printed_variance_m2", json_of(paper.printed_variance)},
                          {"variance_with_zero_row_m2", json_of(with)},
                          {"entry_std_m", json_of(paper.entry_deviation)},
                          {"exit_std_m", json_of(paper.exit_deviation)}};
}

/// Means of the four parts of one axis.
std::string parts_text(const std::vector<BlindArc>& arcs, int axis) {
  ArcParts sum;
  for (const BlindArc& arc : arcs)
    sum.early_end += arc.parts.early_end, sum.late_nose += arc.parts.late_nose,
        sum.speed += arc.parts.speed, sum.slip += arc.parts.slip;
  std::string text;
  for (const Eigen::Vector2d& part : {sum.early_end, sum.late_nose, sum.speed, sum.slip})
    text += (text.empty() ? "" : ", ") + fixed(part[axis] / static_cast<double>(arcs.size()), 2);
  return text;
}

/// A line for each quantity, all sources beside each other.
void report_quantities(const std::vector<ArcSource>& sources, Result& result) {
  const auto line_of = [&](const auto& text) {
    std::string line;
    for (const ArcSource& source : sources)
      if (!source.arcs.empty())
        line += (line.empty() ? "" : "; ") + source.name + " " + text(source);
    return line;
  };
  result.table.push_back(
      {"arcs", "17", line_of([](const ArcSource& s) { return std::to_string(s.arcs.size()); })});
  for (const ArcQuantity& quantity : arc_quantities())
    if (*quantity.name != '\0')
      result.table.push_back({quantity.name, quantity.paper, line_of([&](const ArcSource& s) {
                                return text_of(spread_of(s.arcs, quantity.of));
                              })});
  for (const int axis : {0, 1})
    result.table.push_back({axis == 0 ? "x beyond 0: by 3° left, late nose, speed, slip [m]"
                                      : "y beyond 3: by 3° left, late nose, speed, slip [m]",
                            "-",
                            line_of([&](const ArcSource& s) { return parts_text(s.arcs, axis); })});
  result.json["sources"] = nlohmann::ordered_json::object();
  for (const ArcSource& source : sources) {
    auto& told = result.json["sources"][source.name];
    told["arcs"] = source.arcs.size();
    for (const ArcQuantity& quantity : arc_quantities())
      told[quantity.key] = json_of(spread_of(source.arcs, quantity.of));
  }
}

std::string csv_of(const std::vector<ArcSource>& sources) {
  std::string csv = "source,flight,turn,heading_deg,begin_s,entry_slip_deg,mean_climb_m";
  for (const ArcQuantity& quantity : arc_quantities()) csv += std::string{","} + quantity.key;
  csv += "\n";
  for (const ArcSource& source : sources)
    for (const BlindArc& arc : source.arcs) {
      csv += source.name + "," + arc.flight + "," + (arc.right ? "right" : "left");
      for (const double v : {wrap_angle(arc.heading) / kDegree, arc.begin,
                             arc.entry_slip() / kDegree, arc.mean_climb})
        csv += "," + io::text_of(v, 6);
      for (const ArcQuantity& quantity : arc_quantities())
        csv += "," + io::text_of(quantity.of(arc), 5);
      csv += "\n";
    }
  return csv;
}

}  // namespace

Result arc_accuracy(const Options& options) {
  if (options.stopped()) throw Stopped{};
  const PaperArcs paper;
  const RecordedArcs takes = recorded_arcs(options);
  const std::vector<ArcSource> sources{
      {.name = "recorded", .color = io::look::kDetection, .arcs = takes.arcs(), .told = {}}};
  std::vector<ArcSource> drawn = sources;
  drawn.push_back(
      {.name = "paper (17 arcs: mean and σ)",
       .color = io::look::kGate,
       .arcs = {},
       .told = Spread2{
           .count = paper.count, .mean = paper.mean, .covariance = paper.variance.asDiagonal()}});

  Result result{.table = {},
                .json = {},
                .csv = csv_of(sources),
                .picture = picture_of(drawn, sources.front(), kPlanned)};
  report_quantities(sources, result);
  report_paper(paper, result);
  report_takes(takes, result);
  report_rules(takes, result);
  return result;
}

}  // namespace gatefly::experiments
