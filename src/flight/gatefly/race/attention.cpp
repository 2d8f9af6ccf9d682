// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/attention.hpp"

#include <algorithm>
#include <utility>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly {
namespace {

// Smaller ones are found in one picture of ten [px, of an upright side].
constexpr double kLeastSide = 16.0;

// Between pictures of a camera that is slow [s].
constexpr double kSlow = 0.15;

// How far from upright a gate's bars are in a picture: the attitude is known where the place is not.
struct Rolls {
  double least = 1e3, most = -1e3;  // [rad]
};
void widen_by(Rolls& rolls, const Eigen::Vector2d& px, const Eigen::Vector3d& down_C,
              const AnyCamera& lens) {
  constexpr double kLittle = 0.05;  // of the way to what is seen
  const auto bearing = lens.bearing(px);
  if (!bearing) return;
  const auto lower = lens.project(bearing->normalized() + kLittle * down_C);
  if (!lower) return;
  const Eigen::Vector2d down = *lower - px;
  const double roll = gatefly::atan2(-down.x(), down.y());
  rolls.least = std::min(rolls.least, roll), rolls.most = std::max(rolls.most, roll);
}

}  // namespace

LookFor Attention::next(const eskf::ErrorStateFilter& filter, const SinceTaken& since, double ago,
                        const PictureClock& picture) {
  const auto target = expected_gate(filter, filter.target_slot(), ago, picture);
  bars_.reset();
  if (target && since.any < params_.expect_for) bars_ = target->bars_px;
  if (picture.arrival - std::exchange(arrival_, picture.arrival) > kSlow)
    return of_slow_camera(bars_ && since.target > params_.careful_after, since.any);
  within_ = window(filter, target, since.target < params_.careful_after, ago, picture);
  const bool for_target = within_ && looks_ > 0;
  return {.gates = for_target ? LookFor::Gates::kStandingOut : LookFor::Gates::kAll,
          .expected_bars = bars_ ? &*bars_ : nullptr,
          .quick = !within_,
          .within = within_ ? &*within_ : nullptr};
}

// There is time for all of every picture.
LookFor Attention::of_slow_camera(bool target_is_missing, double since_any) {
  const bool careful =
      target_is_missing || since_any > params_.expect_for || ++looks_ >= params_.careful_every;
  if (careful) looks_ = 0;
  return {.gates = careful ? LookFor::Gates::kAll : LookFor::Gates::kStandingOut,
          .expected_bars = bars_ ? &*bars_ : nullptr,
          .quick = !careful};
}

// What to search carefully; looks_ is 0 where it is not for the target.
std::optional<SearchWindow> Attention::window(const eskf::ErrorStateFilter& filter,
                                              const std::optional<ExpectedGate>& target,
                                              bool just_seen, double ago,
                                              const PictureClock& picture) {
  const bool is_lost =
      std::max(filter.sigma(eskf::kP), filter.sigma(eskf::kP + 1)) > params_.lost_sigma;
  const bool is_missing = target && target->shows_whole && !just_seen,
             is_due = is_lost || ++looks_ >= params_.careful_every;
  if (!is_due) return is_missing ? std::optional{target->window} : std::nullopt;
  looks_ = 0;
  parts_ = is_lost || is_missing || (!just_seen && !parts_);
  if (parts_) return next_part(filter, ago, picture);
  return another_gate(filter, ago, picture);
}

// The next gate, by slots, that should show whole.
std::optional<SearchWindow> Attention::another_gate(const eskf::ErrorStateFilter& filter,
                                                    double ago, const PictureClock& picture) {
  const int slots = filter.landmarks().slots();
  for (int k = 0; k < slots; ++k) {
    slot_ = (slot_ + 1) % slots;
    if (slot_ == filter.target_slot()) continue;
    const auto gate = expected_gate(filter, slot_, ago, picture);
    if (gate && gate->shows_whole && gate->window.most_side > kLeastSide) return gate->window;
  }
  return std::nullopt;
}

// Three halves of the picture, a quarter apart, for what fits into a quarter; all of it for what is larger,
// of which few sizes are left.
SearchWindow Attention::next_part(const eskf::ErrorStateFilter& filter, double ago,
                                  const PictureClock& picture) {
  constexpr int kHalves = 3;
  constexpr double kAnySize = 1e6, kRollOff = 10.0 * kDegree, kAnyRoll = 0.5 * kPi;
  const int part = std::exchange(part_, (part_ + 1) % (kHalves + 1));
  const double width = picture.size_px.x(), height = picture.size_px.y(), quarter = 0.25 * width;
  SearchWindow window = part == kHalves ? SearchWindow{0.0, 0.0, width, height, quarter, kAnySize}
                                        : SearchWindow{part * quarter, 0.0, (part + 2) * quarter,
                                                       height,         0.0, quarter};
  const eskf::Nominal& x = filter.now();
  const Eigen::Matrix3d R_EC = x.R_EB * rotation_of(-ago * x.rate_B) * x.R_BC;
  const Eigen::Vector3d down_C = R_EC.row(2);
  Rolls rolls;
  for (const double u : {window.left, window.right})
    for (const double v : {0.25 * height, 0.75 * height})
      widen_by(rolls, {u, v}, down_C, picture.camera.lens);
  if (rolls.most < rolls.least || rolls.most - rolls.least > kAnyRoll) return window;
  window.least_roll = rolls.least - kRollOff, window.most_roll = rolls.most + kRollOff;
  return window;
}

}  // namespace gatefly
