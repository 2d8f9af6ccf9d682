// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/arc_table.hpp"

#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {

const std::array<ArcQuantity, 20>& arc_quantities() {
  static const std::array<ArcQuantity, 20> list{{
      {"displacement x, planned 0 [m]", "displacement_x_m", "-0.33 ± 0.16",
       [](const BlindArc& a) { return a.displacement().x(); }},
      {"displacement y, planned 3 [m]", "displacement_y_m", "3.67 ± 0.26",
       [](const BlindArc& a) { return a.displacement().y(); }},
      {"duration [s]", "duration_s", "around 2; 2.8 in their EKF figure",
       [](const BlindArc& a) { return a.duration(); }},
      {"speed at the entry [m/s]", "entry_speed_mps", "? ± 0.07",
       [](const BlindArc& a) { return a.entry_speed(); }},
      {"speed at the exit [m/s]", "exit_speed_mps", "",
       [](const BlindArc& a) { return a.exit_speed(); }},
      {"speed lost between them [m/s]", "speed_loss_mps", "",
       [](const BlindArc& a) { return a.entry_speed() - a.exit_speed(); }},
      {"mean speed [m/s]", "mean_speed_mps", "", [](const BlindArc& a) { return a.mean_speed; }},
      {"  as the yaw rate tells it, times 1.5 m", "believed_speed_mps", "",
       [](const BlindArc& a) { return a.believed_speed; }},
      {"radius of the circle that fits [m]", "radius_m", "planned 1.5",
       [](const BlindArc& a) { return a.radius; }},
      {"course at the exit beyond +180° [°]", "exit_slip_deg", "",
       [](const BlindArc& a) { return a.exit_slip() / kDegree; }},
      {"mean pitch in the arc [°]", "mean_pitch_deg", "commanded -5",
       [](const BlindArc& a) { return a.mean_pitch / kDegree; }},
      {"largest height change [m]", "max_climb_m", "",
       [](const BlindArc& a) { return a.max_climb; }},
      {"", "by_early_end_x_m", "", [](const BlindArc& a) { return a.parts.early_end.x(); }},
      {"", "by_late_nose_x_m", "", [](const BlindArc& a) { return a.parts.late_nose.x(); }},
      {"", "by_speed_x_m", "", [](const BlindArc& a) { return a.parts.speed.x(); }},
      {"", "by_slip_x_m", "", [](const BlindArc& a) { return a.parts.slip.x(); }},
      {"", "by_early_end_y_m", "", [](const BlindArc& a) { return a.parts.early_end.y(); }},
      {"", "by_late_nose_y_m", "", [](const BlindArc& a) { return a.parts.late_nose.y(); }},
      {"", "by_speed_y_m", "", [](const BlindArc& a) { return a.parts.speed.y(); }},
      {"", "by_slip_y_m", "", [](const BlindArc& a) { return a.parts.slip.y(); }},
  }};
  return list;
}

Spread1 spread_of(const std::vector<BlindArc>& arcs, double (*value)(const BlindArc&)) {
  std::vector<double> values;
  for (const BlindArc& arc : arcs) values.push_back(value(arc));
  return spread_of(values);
}

Spread2 ends_of(const std::vector<BlindArc>& arcs) {
  std::vector<Eigen::Vector2d> ends;
  for (const BlindArc& arc : arcs) ends.push_back(arc.displacement());
  return spread_of(ends);
}

std::string text_of(const Spread1& spread) {
  return files::fixed(spread.mean, 2) + " ± " + files::fixed(spread.deviation, 2);
}

std::string text_of(const Eigen::Vector2d& p) {
  return "(" + files::fixed(p.x(), 2) + ", " + files::fixed(p.y(), 2) + ")";
}

nlohmann::ordered_json json_of(const Spread1& spread) {
  return {{"mean", files::number(spread.mean)}, {"std", files::number(spread.deviation)}};
}

nlohmann::ordered_json json_of(const Eigen::Vector2d& p) {
  return {files::number(p.x()), files::number(p.y())};
}

std::string parts_text(const std::vector<BlindArc>& arcs, int axis) {
  ArcParts sum;
  for (const BlindArc& arc : arcs)
    sum.early_end += arc.parts.early_end, sum.late_nose += arc.parts.late_nose,
        sum.speed += arc.parts.speed, sum.slip += arc.parts.slip;
  std::string text;
  for (const Eigen::Vector2d& part : {sum.early_end, sum.late_nose, sum.speed, sum.slip})
    text +=
        (text.empty() ? "" : ", ") + files::fixed(part[axis] / static_cast<double>(arcs.size()), 2);
  return text;
}

}  // namespace gatefly::experiments
