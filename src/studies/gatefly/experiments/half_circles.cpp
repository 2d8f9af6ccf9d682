// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/half_circles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kPathMargin = 0.5;  // of the drawn path, on both sides [s]

using Window = std::pair<std::size_t, std::size_t>;  // first, one after the last

/// One turn that may be a half circle.
class Turn {
 public:
  Turn(std::span<const SmoothSample> motion, const HalfCircleRule& rule, const Window& run)
      : motion_{motion}, rule_{rule}, run_{run} {
    std::vector<double> rates;
    for (std::size_t i = run.first; i < run.second; ++i)
      if (motion[i].tracked) rates.push_back(motion[i].yaw_rate);
    rate_ = files::nearest_rank(rates, 0.5);
    sign_ = rate_ < 0.0 ? -1.0 : 1.0;
    // Backwards from the middle, so that a slower start belongs to it.
    begin_ = end_ = (run.first + run.second) / 2;
    while (begin_ > 0 && sign_ * motion[begin_ - 1].yaw_rate > rule.begin_part * sign_ * rate_)
      --begin_;
    std::vector<double> before;
    for (std::size_t i = begin_; i-- > 0 && is_within(i, begin_, rule.straight_before);)
      before.push_back(motion[i].yaw);
    heading_ = before.empty() ? motion[begin_].yaw : files::nearest_rank(before, 0.5);
    while (end_ < motion.size() && turned(end_) < kPi - rule.end_within) ++end_;
  }

  /// Why it is no half circle; empty when it is one.
  [[nodiscard]] std::string fault() const {
    const std::string at_most = fixed_deg(most_turned());
    if (end_ >= motion_.size() || motion_[end_].t > motion_[run_.second - 1].t + kEndTime)
      return "turned by " + at_most + " only";
    if (tracked_part() < rule_.min_tracked || !motion_[begin_].tracked || !motion_[end_].tracked)
      return "lost for " + files::fixed(100.0 * (1.0 - tracked_part()), 0) + " % of its time";
    if (!is_held_before()) return "no straight before it";
    if (!is_settled_after()) return "no straight after it: turned by " + at_most;
    for (std::size_t i = begin_; i <= end_; ++i) {
      if (std::abs(motion_[i].p_E.z() - motion_[begin_].p_E.z()) > rule_.max_climb)
        return "not level";
      if (motion_[i].v_E.head<2>().norm() < rule_.min_speed)
        return "slower than " + files::text_of(rule_.min_speed) + " m/s";
    }
    const double slip = arc().entry_slip();
    if (std::abs(slip) > rule_.max_entry_slip)
      return "entered sideways: course " + fixed_deg(slip) + " off the nose";
    return "";
  }
  [[nodiscard]] BlindArc arc() const {
    return arc_between(
        motion_,
        crossing(begin_, rule_.begin_part * sign_ * rate_,
                 [&](std::size_t i) { return sign_ * motion_[i].yaw_rate; }),
        crossing(end_, kPi - rule_.end_within, [&](std::size_t i) { return turned(i); }), heading_,
        sign_ > 0.0);
  }
  [[nodiscard]] LeftOut left_out() const {
    return {motion_[run_.first].t, motion_[run_.second - 1].t, fault()};
  }

 private:
  static constexpr double kEndTime = 0.5;  // the end comes within this of the turning's [s]

  /// When `value` rose through `level`, between sample i - 1 and sample i.
  template <class Value>
  [[nodiscard]] double crossing(std::size_t i, double level, const Value& value) const {
    if (i == 0 || !(value(i - 1) < level && value(i) >= level)) return motion_[i].t;
    const double part = (level - value(i - 1)) / (value(i) - value(i - 1));
    return motion_[i - 1].t + part * (motion_[i].t - motion_[i - 1].t);
  }
  static std::string fixed_deg(double angle) { return files::fixed(angle / kDegree, 0) + "°"; }
  [[nodiscard]] double turned(std::size_t i) const { return sign_ * (motion_[i].yaw - heading_); }
  [[nodiscard]] bool is_within(std::size_t a, std::size_t b, double time) const {
    return std::abs(motion_[a].t - motion_[b].t) <= time;
  }
  [[nodiscard]] double most_turned() const {
    double most = 0.0;
    for (std::size_t i = begin_;
         i < motion_.size() && motion_[i].t <= motion_[run_.second - 1].t + kEndTime; ++i)
      if (motion_[i].tracked) most = std::max(most, turned(i));
    return most;
  }
  [[nodiscard]] double tracked_part() const {
    double tracked = 0.0, whole = 0.0;
    for (std::size_t i = 1; i < motion_.size(); ++i) {
      if (motion_[i].t < motion_[begin_].t - rule_.straight_before ||
          motion_[i].t > motion_[end_].t + rule_.straight_after)
        continue;
      const double dt = motion_[i].t - motion_[i - 1].t;
      whole += dt;
      if (motion_[i].tracked && motion_[i - 1].tracked) tracked += dt;
    }
    return whole > 0.0 ? tracked / whole : 0.0;
  }
  [[nodiscard]] bool is_held_before() const {
    std::size_t i = begin_;
    while (i > 0 && is_within(i, begin_, rule_.straight_before)) {
      if (motion_[i].tracked && std::abs(turned(i)) > rule_.held_within) return false;
      --i;
    }
    return !is_within(i, begin_, rule_.straight_before);  // the recording is long enough
  }
  [[nodiscard]] bool is_settled_after() const {
    std::size_t i = end_;
    for (; i < motion_.size() && is_within(i, end_, rule_.straight_after); ++i)
      if (motion_[i].tracked && std::abs(turned(i) - kPi) > rule_.settled_within) return false;
    return i < motion_.size();
  }

  std::span<const SmoothSample> motion_;
  HalfCircleRule rule_;
  Window run_;
  std::size_t begin_ = 0, end_ = 0;
  double rate_ = 0.0, sign_ = 1.0, heading_ = 0.0;
};

/// The arc's speeds, and the parts of its displacement.
void explain(BlindArc& arc, std::span<const SmoothSample> motion, const PlannedArc& planned) {
  // The attitude loop has followed the command: three times its 0.14 s [Li18's INDI, 14 rad/s], but
  // never more than a fifth of the arc.
  const double settle = std::min(0.42, 0.2 * arc.duration());
  const double sign = arc.right ? 1.0 : -1.0, r = planned.radius;
  const auto nose = [&](const SmoothSample& s) { return sign * (s.yaw - arc.heading); };
  // Commanded from the start: the mean rate of the next stretch as long.
  const double t1 = arc.begin + settle, t2 = arc.begin + 2.0 * settle;
  const double first_speed = r * (nose(at(motion, t2)) - nose(at(motion, t1))) / (t2 - t1);
  constexpr int kSteps = 1000;
  const double dt = arc.duration() / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double t = arc.begin + (i + 0.5) * dt;
    const SmoothSample s = at(motion, t);
    const double psi = nose(s), flown = r * sign * s.yaw_rate, v = s.v_E.head<2>().norm();
    const double commanded = t < t1 ? first_speed : flown;
    const Eigen::Vector2d ahead{std::cos(psi), std::sin(psi)};
    arc.parts.late_nose += dt * (commanded - flown) * ahead;
    arc.parts.speed += dt * (v - commanded) * ahead;
    arc.parts.slip += dt * (arc.in_entry_frame(s.v_E.head<2>()) - v * ahead);
    arc.believed_speed += commanded / kSteps, arc.mean_speed += v / kSteps;
  }
  const double from = nose(at(motion, arc.begin)), to = nose(at(motion, arc.end));
  arc.parts.early_end =
      r * Eigen::Vector2d{std::sin(to) - std::sin(from), std::cos(from) - std::cos(to) - 2.0};
}

/// Stretches of fast turning to one side.
std::vector<Window> turns_of(std::span<const SmoothSample> motion, const HalfCircleRule& rule) {
  std::vector<Window> runs;
  const auto is_turning = [&](std::size_t i) {
    return motion[i].tracked && std::abs(motion[i].yaw_rate) > rule.turning;
  };
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (!is_turning(i)) continue;
    const bool goes_on = !runs.empty() &&
                         motion[i].t - motion[runs.back().second - 1].t <= rule.max_pause &&
                         motion[i].yaw_rate * motion[runs.back().second - 1].yaw_rate > 0.0;
    if (goes_on)
      runs.back().second = i + 1;
    else
      runs.emplace_back(i, i + 1);
  }
  std::erase_if(runs, [&](const Window& run) {
    return motion[run.second - 1].t - motion[run.first].t < rule.min_time;
  });
  return runs;
}

}  // namespace

BlindArc arc_between(std::span<const SmoothSample> motion, double begin, double end, double heading,
                     bool right, const PlannedArc& planned) {
  const SmoothSample a = at(motion, begin), b = at(motion, end);
  BlindArc arc{.flight = {},
               .right = right,
               .begin = begin,
               .end = end,
               .entry = a.p_E.head<2>(),
               .exit = b.p_E.head<2>(),
               .v_entry = a.v_E.head<2>(),
               .v_exit = b.v_E.head<2>(),
               .heading = heading};
  std::vector<Eigen::Vector2d> inside;
  for (const SmoothSample& s : motion) {
    if (!s.tracked || s.t < begin - kPathMargin || s.t > end + kPathMargin) continue;
    arc.path.emplace_back(s.p_E.head<2>());
    if (s.t < begin || s.t > end) continue;
    inside.emplace_back(s.p_E.head<2>());
    const double climb = a.p_E.z() - s.p_E.z();
    arc.mean_climb += climb, arc.mean_pitch += s.pitch;
    if (std::abs(climb) > std::abs(arc.max_climb)) arc.max_climb = climb;
  }
  const double n = std::max(1.0, static_cast<double>(inside.size()));
  arc.mean_climb /= n, arc.mean_pitch /= n;
  arc.radius = fitted_radius(inside);
  explain(arc, motion, planned);
  return arc;
}

HalfCircles find_half_circles(std::span<const SmoothSample> motion, const HalfCircleRule& rule) {
  HalfCircles found;
  for (const Window& run : turns_of(motion, rule)) {
    const Turn turn{motion, rule, run};
    if (turn.fault().empty())
      found.arcs.push_back(turn.arc());
    else
      found.left_out.push_back(turn.left_out());
  }
  return found;
}

}  // namespace gatefly::experiments
