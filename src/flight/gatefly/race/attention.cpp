// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/attention.hpp"

#include <algorithm>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly {
namespace {

// The smallest frame that is tried has 18 px; a fit that begins there reaches this [px].
constexpr double kLeastSide = 14.0;

// Time between pictures of a camera that is slow [s]. [estimate]
constexpr double kSlow = 0.075;

// A picture's parts: three halves that overlap, and all of it for large gates.
constexpr int kParts = 4;

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

LookFor Attention::next(const eskf::ErrorStateFilter& filter, const Known& known, double ago,
                        const PictureClock& picture) {
  const auto target = expected_gate(filter, filter.target_slot(), ago, picture);
  bars_.reset();
  if (target && known.since_any < params_.expect_for) bars_ = target->bars_px;
  if (picture.interval > kSlow)
    return at_all(bars_ && known.since_target > params_.careful_after, known.since_any);
  within_ = window(filter, target, known, ago, picture);
  const bool for_target = within_ && looks_ > 0;
  return {.gates = for_target ? LookFor::Gates::kStandingOut : LookFor::Gates::kAll,
          .expected_bars = bars_ ? &*bars_ : nullptr,
          .quick = !within_,
          .within = within_ ? &*within_ : nullptr};
}

LookFor Attention::at_all(bool target_is_missing, double since_any) {
  const bool careful =
      target_is_missing || since_any > params_.expect_for || ++looks_ >= params_.careful_every;
  if (careful) looks_ = 0;
  return {.gates = careful ? LookFor::Gates::kAll : LookFor::Gates::kStandingOut,
          .expected_bars = bars_ ? &*bars_ : nullptr,
          .quick = !careful};
}

// The part of this picture to search carefully. Sets looks_ to 0 where it is not the target's.
std::optional<SearchWindow> Attention::window(const eskf::ErrorStateFilter& filter,
                                              const std::optional<ExpectedGate>& target,
                                              const Known& known, double ago,
                                              const PictureClock& picture) {
  const bool is_lost = place_sigma(filter) > params_.lost_sigma,
             is_blind = known.since_any > params_.expect_for,
             just_seen = known.since_target < params_.careful_after,
             is_missing =
                 target && target->shows_whole && target->side_px > kLeastSide && !just_seen;
  ++looks_;
  // A gate seen elsewhere than expected is believed if the next picture shows it, too.
  const bool again = known.waits && looks_ == 1;
  const int every = is_lost ? 1 : is_blind ? params_.blind_every : params_.careful_every;
  if (looks_ < every && !again) return is_missing ? std::optional{target->window} : std::nullopt;
  looks_ = 0;
  if (!again) {
    parts_ = is_lost || is_blind || (!just_seen && !parts_);
    if (parts_)
      part_ = (part_ + 1) % kParts;
    else
      slot_ = another_slot(filter, ago, picture);
  }
  if (parts_) return part(filter, ago, picture);
  if (slot_ == filter.target_slot()) return std::nullopt;
  const auto gate = expected_gate(filter, slot_, ago, picture);
  return gate ? std::optional{gate->window} : std::nullopt;
}

// The next gate, in the order of slots, that should show whole; the target where there is none.
int Attention::another_slot(const eskf::ErrorStateFilter& filter, double ago,
                            const PictureClock& picture) const {
  const int slots = filter.landmarks().slots();
  for (int k = 1; k <= slots; ++k) {
    const int slot = (slot_ + k) % slots;
    if (slot == filter.target_slot()) continue;
    const auto gate = expected_gate(filter, slot, ago, picture);
    if (gate && gate->shows_whole && gate->side_px > kLeastSide) return slot;
  }
  return filter.target_slot();
}

// Three windows half as wide as the picture, a quarter apart: what is narrower than a quarter is whole in
// one of them. Then all of the picture for what is larger, of which few sizes are left to try.
SearchWindow Attention::part(const eskf::ErrorStateFilter& filter, double ago,
                             const PictureClock& picture) const {
  constexpr double kRollOff = 10.0 * kDegree, kAnyRoll = 0.5 * kPi;
  const double width = picture.size_px.x(), height = picture.size_px.y(), quarter = 0.25 * width;
  SearchWindow window{.left = 0.0, .top = 0.0, .right = width, .bottom = height};
  if (part_ == kParts - 1)
    window.least_side = quarter;
  else
    window.left = part_ * quarter, window.right = (part_ + 2) * quarter, window.most_side = quarter;
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
