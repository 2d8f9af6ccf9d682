// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/delayed_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
DelayedFilter::DelayedFilter(const DragFilterParams& params, std::size_t moments,
                             const RestartParams& restart)
    : restart_{restart},
      moments_(std::max<std::size_t>(2, moments),
               Moment{.input = {}, .heights = {}, .filter = DragFilter{params}}) {}

std::size_t moments_for(double seconds, double imu_hz) {
  return static_cast<std::size_t>(std::max(2.0, std::ceil(seconds * imu_hz)));
}

void DelayedFilter::start(const Eigen::Vector3d& p_G, const Eigen::Vector3d& accel_bias,
                          const MapUncertainty& uncertainty, double time) {
  newest().filter.start(p_G, accel_bias, uncertainty);
  newest().time = time;
  forget_past();
}

void DelayedFilter::forget_past() {
  first_ = count_ - 1;
  newest().heights.clear();
  fixes_.clear();
  run_ = {};
}

void DelayedFilter::predict(const drag_model::Input& input, double dt, double time) {
  const Moment& last = newest();
  Moment& next = moment(count_);
  next.filter = last.filter;
  next.filter.predict(input, dt);
  next.odometry = last.odometry + (next.filter.position() - last.filter.position());
  next.time = time, next.dt = dt, next.input = input;
  next.heights.clear();
  ++count_;
}

Fusion DelayedFilter::correct_altitude(double z_G, double sigma, double height_sigma) {
  (void)newest().heights.push_back({z_G, sigma, height_sigma});
  return newest().filter.correct_altitude(z_G, sigma, height_sigma);
}

std::optional<std::size_t> DelayedFilter::index_at(double time) const {
  if (!std::isfinite(time)) return std::nullopt;
  std::size_t i = count_ - 1;
  const auto off = [&](std::size_t k) { return std::abs(moment(k).time - time); };
  // At most once a moment kept.
  while (i > oldest() && off(i - 1) <= off(i)) --i;
  // The oldest moment has none before it from which it could be done again.
  if (i == oldest() && (i != count_ - 1 || time < newest().time)) return std::nullopt;
  return i;
}

const DelayedFilter::Moment* DelayedFilter::at(double time) const {
  const auto i = index_at(time);
  return i ? &moment(*i) : nullptr;
}

Fusion DelayedFilter::correct(const Fix& fix, double time, bool may_restart) {
  const auto index = index_at(time);
  if (!index || *index == oldest()) return Fusion::kTooLate;
  const auto gone = [&] {
    return fixes_.full() || (!fixes_.empty() && fixes_[0].time < moment(oldest()).time);
  };
  // At most once a fix kept.
  while (gone()) {
    std::move(fixes_.begin() + 1, fixes_.end(), fixes_.begin());
    fixes_.pop_back();
  }
  (void)fixes_.push_back({time, fix});
  insertion_sort(fixes_, [](const Dated& a, const Dated& b) { return a.time < b.time; });
  const Eigen::Vector3d odometry = moment(*index).odometry;
  const Fusion fusion = redo_from(*index, time);
  if (fusion == Fusion::kAccepted) run_ = {};
  if (fusion != Fusion::kRefused || !may_restart || !agreed(fix, time, odometry)) return fusion;
  Fix present = fix;
  present.p_GB += newest().odometry - odometry;
  newest().filter.restart(present);
  forget_past();
  return Fusion::kRestarted;
}

// All ticks from `index` on once more, with the heights and fixes of each; what became of the fix
// of `time`.
Fusion DelayedFilter::redo_from(std::size_t index, double time) {
  Fusion fusion = Fusion::kRefused;
  std::size_t f = 0;
  // At most once a fix kept.
  while (f < fixes_.size() && index_at(fixes_[f].time).value_or(0) < index) ++f;
  for (std::size_t i = index; i < count_; ++i) {
    Moment& now = moment(i);
    now.filter = moment(i - 1).filter;
    now.filter.predict(now.input, now.dt);
    for (const Moment::Height& height : now.heights)
      (void)now.filter.correct_altitude(height.z, height.sigma, height.systematic);
    // At most once a fix kept, all ticks together.
    for (; f < fixes_.size() && index_at(fixes_[f].time) == i; ++f) {
      const Fusion one = now.filter.correct(fixes_[f].fix);
      if (fixes_[f].time == time) fusion = one;
    }
  }
  return fusion;
}

// Whether enough refused fixes agree. Outliers in between count against it [Boyer, Moore
// 1981].
bool DelayedFilter::agreed(const Fix& fix, double time, const Eigen::Vector3d& odometry) {
  if (run_.count > 0 && time <= run_.last) return false;  // a picture counts once
  const Eigen::Vector3d start = fix.p_GB - odometry;
  const Eigen::Matrix3d random_covariance =
      fix.systematic.isZero(0.0) ? fix.covariance : fix.random_covariance;
  const double drift = restart_.odometry * (time - run_.since);
  const Eigen::Matrix3d S =
      run_.covariance + random_covariance + drift * drift * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d apart = start - run_.start;
  if (run_.count == 0 || time - run_.since > restart_.longest) {
    run_ = {1, time, time, start, random_covariance};
    return false;
  }
  run_.last = time;
  if (!(apart.dot(S.ldlt().solve(apart)) < 9.0)) {
    --run_.count;
    return false;
  }
  ++run_.count;
  return run_.count >= restart_.fixes && time - run_.since >= restart_.duration;
}

void DelayedFilter::change_frame(const Eigen::Matrix3d& R, const Eigen::Vector3d& offset,
                                 double turn, const MapUncertainty& uncertainty) {
  newest().filter.change_frame(R, offset, uncertainty);
  newest().input.yaw = wrap_angle(newest().input.yaw + turn);
  forget_past();
}

void DelayedFilter::reset_position(const Eigen::Vector2d& p_G, double sigma) {
  newest().filter.reset_position(p_G, sigma);
  forget_past();
}

void DelayedFilter::turn_past(double angle) {
  for (std::size_t i = oldest(); i < count_; ++i) {
    double& yaw = moment(i).input.yaw;
    yaw = wrap_angle(yaw + angle);
  }
}

}  // namespace gatefly
