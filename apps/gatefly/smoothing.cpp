// SPDX-License-Identifier: Apache-2.0
#include "smoothing.hpp"

#include <cmath>
#include <stdexcept>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/smoothing/alignment.hpp"
#include "gatefly/tasks/smoothing/smoother.hpp"

namespace gatefly::cli {
namespace {

using Eigen::Vector3d;

nlohmann::json as_list(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json as_json(const smoothing::Alignment& a) {
  return {{"rmse_m", as_list(a.rms)}, {"lag_ms", 1e3 * a.lag}, {"turned_deg", a.turned / kDegree}};
}

std::string one_beside_other(const Vector3d& filter, const Vector3d& smoothed) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    text += std::string{axis > 0 ? ", " : ""} + "xyz"[axis] + ' ' + files::fixed(filter(axis), 3) +
            " | " + files::fixed(smoothed(axis), 3);
  return text + " m, together " + files::fixed(filter.norm(), 3) + " | " +
         files::fixed(smoothed.norm(), 3);
}

class Follower : public FlightSmoother {
 public:
  void follow(const flight_log::ReplayedTick& tick) override {
    Seen seen;
    if (const auto* filter = tick.pilot.navigator().error_state()) {
      watch_.update(*filter, tick.sensors.image || tick.sensors.seen);
      if (filter->has_started())
        seen = {filter->landmarks().in_slot(filter->target_slot()), filter->target_behind(),
                filter->now().p_EB};
    }
    rows_.push_back(seen);
  }

  SmoothedFlight smoothed(const tasks::RecordedFlight& flight,
                          const flight_log::ReplayResult& result,
                          const std::function<void()>& now_and_then) override {
    if (!watch_.has_started() || watch_.intake().ticks.empty())
      throw std::runtime_error(flight.folder.directory.string() +
                               ": never takes off, there is nothing to smooth");
    const auto path = smoothing::smooth(watch_.intake(), {}, now_and_then);
    SmoothedFlight out;
    out.estimates = result.estimates;
    std::vector<smoothing::Place> filtered, found, truth;
    Vector3d filter2 = Vector3d::Zero(), found2 = Vector3d::Zero();
    int rows = 0;
    for (std::size_t i = 0; i < out.estimates.size(); ++i) {
      flight_log::EstimateRow& row = out.estimates[i];
      const eskf::Nominal x = smoothing::at(path, row.t);
      put(x, path, rows_[i], row.estimate);
      filtered.push_back({row.t, rows_[i].p_EB}), found.push_back({row.t, x.p_EB});
      const auto& p_EB = flight.ticks[i].p_EB;
      const bool counts = result.first_fix && row.t >= *result.first_fix &&
                          !(result.last_gate && row.t >= *result.last_gate);
      if (!p_EB || !counts) continue;
      filter2 += (rows_[i].p_EB - *p_EB).cwiseAbs2(), found2 += (x.p_EB - *p_EB).cwiseAbs2();
      ++rows;
      // Motion capture comes less often than the IMU: the row in which it is new.
      if (truth.empty() || truth.back().p_EB != *p_EB) truth.push_back({row.t, *p_EB});
    }
    out.json = {{"passes", path.passes},    {"settled", path.settled}, {"rmse_samples", rows},
                {"filter_rmse_m", nullptr}, {"rmse_m", nullptr},       {"filter_aligned", nullptr},
                {"aligned", nullptr}};
    if (!path.settled)
      out.lines.push_back("smoothed        has not settled after " + std::to_string(path.passes) +
                          " passes: take it with care");
    if (rows == 0) return out;
    const Vector3d of_filter = (filter2 / rows).cwiseSqrt(), of_all = (found2 / rows).cwiseSqrt();
    out.json["filter_rmse_m"] = as_list(of_filter), out.json["rmse_m"] = as_list(of_all);
    out.lines.push_back("filter|smoothed rms " + one_beside_other(of_filter, of_all));
    const auto a = smoothing::aligned(filtered, truth), b = smoothing::aligned(found, truth);
    if (!a || !b) return out;
    out.json["filter_aligned"] = as_json(*a), out.json["aligned"] = as_json(*b);
    out.lines.push_back("        aligned rms " + one_beside_other(a->rms, b->rms) +
                        ": but for a shift, a heading and a lag of the truth (" +
                        files::fixed(1e3 * b->lag, 0) + " ms)");
    return out;
  }

 private:
  /// The IMU sample that the filter flew by in a row.
  struct Seen {
    std::size_t landmark = 0;
    bool behind = false;
    Vector3d p_EB = Vector3d::Zero();
  };

  static void put(const eskf::Nominal& x, const smoothing::Smoothed& path, const Seen& seen,
                  Estimate& estimate) {
    estimate.p_EB = x.p_EB, estimate.v_E = x.v_E;
    estimate.attitude = attitude_of(RotationEB{x.R_EB});
    estimate.accel_bias = x.accel_bias, estimate.gyro_bias = x.gyro_bias;
    const eskf::GateBelief& gate = path.gates[seen.landmark];
    estimate.p_GB = rotation_z(-gate.yaw_EG - (seen.behind ? kPi : 0.0)) * (x.p_EB - gate.p_EG);
  }

  smoothing::IntakeWatch watch_;
  std::vector<Seen> rows_;
};

}  // namespace

std::unique_ptr<FlightSmoother> flight_smoother() { return std::make_unique<Follower>(); }

}  // namespace gatefly::cli
