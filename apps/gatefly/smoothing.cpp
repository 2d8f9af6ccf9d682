// SPDX-License-Identifier: Apache-2.0
#include "smoothing.hpp"

#include <cmath>
#include <stdexcept>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/smoothing/smoother.hpp"

namespace gatefly::cli {
namespace {

using Eigen::Vector3d;

/// Squared errors of filter and smoother over the same rows.
struct Errors {
  Vector3d filter = Vector3d::Zero(), smoothed = Vector3d::Zero();
  int rows = 0;

  void add(const Vector3d& of_filter, const Vector3d& of_smoother) {
    filter += of_filter.cwiseAbs2(), smoothed += of_smoother.cwiseAbs2();
    ++rows;
  }
  [[nodiscard]] Vector3d rms(const Vector3d& sum) const {
    return (sum / std::max(1, rows)).cwiseSqrt();
  }
};

nlohmann::json as_list(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string in_words(const Errors& errors) {
  const Vector3d f = errors.rms(errors.filter), s = errors.rms(errors.smoothed);
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    text += std::string{axis > 0 ? ", " : ""} + "xyz"[axis] + ' ' + io::fixed(f(axis), 3) + " | " +
            io::fixed(s(axis), 3);
  return text + " m, together " + io::fixed(f.norm(), 3) + " | " + io::fixed(s.norm(), 3);
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
    seen.on_map = static_cast<std::size_t>(tick.pilot.target_gate());
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
    Errors in_room, at_gate;
    for (std::size_t i = 0; i < out.estimates.size(); ++i) {
      flight_log::EstimateRow& row = out.estimates[i];
      const Estimate by_filter = row.estimate;
      const eskf::Nominal x = smoothing::at(path, row.t);
      put(x, path, rows_[i], row.estimate);
      const auto& truth = flight.ticks[i].p_EB;
      const bool counts = result.first_fix && row.t >= *result.first_fix &&
                          !(result.last_gate && row.t >= *result.last_gate);
      if (!truth || !counts) continue;
      in_room.add(rows_[i].p_EB - *truth, x.p_EB - *truth);
      const MapGate& gate = flight.pilot.track.gates[rows_[i].on_map];
      const Vector3d true_GB = rotation_z(-gate.yaw_EG) * (*truth - gate.p_EG);
      at_gate.add(by_filter.p_GB - true_GB, row.estimate.p_GB - true_GB);
    }
    tell(out, path, in_room, at_gate, flight.simulated);
    return out;
  }

 private:
  /// What the filter flew by in a row.
  struct Seen {
    std::size_t landmark = 0;
    bool behind = false;
    Vector3d p_EB = Vector3d::Zero();
    std::size_t on_map = 0;  ///< The target's index.
  };

  static void put(const eskf::Nominal& x, const smoothing::Smoothed& path, const Seen& seen,
                  Estimate& estimate) {
    estimate.p_EB = x.p_EB, estimate.v_E = x.v_E;
    estimate.attitude = attitude_of(RotationEB{x.R_EB});
    estimate.accel_bias = x.accel_bias, estimate.gyro_bias = x.gyro_bias;
    const eskf::GateBelief& gate = path.gates[seen.landmark];
    estimate.p_GB = rotation_z(-gate.yaw_EG - (seen.behind ? kPi : 0.0)) * (x.p_EB - gate.p_EG);
  }

  // The map's gates are where truth has them only if somebody measured both: in recorded flights.
  static void tell(SmoothedFlight& out, const smoothing::Smoothed& path, const Errors& in_room,
                   const Errors& at_gate, bool simulated) {
    out.json = {
        {"passes", path.passes},    {"settled", path.settled}, {"rmse_samples", in_room.rows},
        {"filter_rmse_m", nullptr}, {"rmse_m", nullptr},       {"filter_gate_rmse_m", nullptr},
        {"gate_rmse_m", nullptr}};
    if (!path.settled)
      out.lines.push_back("smoothed        has not settled after " + std::to_string(path.passes) +
                          " passes: take it with care");
    if (in_room.rows == 0) return;
    out.json["filter_rmse_m"] = as_list(in_room.rms(in_room.filter));
    out.json["rmse_m"] = as_list(in_room.rms(in_room.smoothed));
    out.lines.push_back("filter|smoothed rms " + in_words(in_room) + ", in the room");
    if (simulated) return;
    out.json["filter_gate_rmse_m"] = as_list(at_gate.rms(at_gate.filter));
    out.json["gate_rmse_m"] = as_list(at_gate.rms(at_gate.smoothed));
    out.lines.push_back("                rms " + in_words(at_gate) + ", from the gate");
  }

  smoothing::IntakeWatch watch_;
  std::vector<Seen> rows_;
};

}  // namespace

std::unique_ptr<FlightSmoother> flight_smoother() { return std::make_unique<Follower>(); }

}  // namespace gatefly::cli
