// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tum_file.hpp"

#include <chrono>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::tasks {
namespace {

void append(std::string& text, double t, const Eigen::Vector3d& p, const Quaternion& q) {
  text += files::text_of(t);
  for (const double value : {p.x(), p.y(), p.z(), q.x, q.y, q.z, q.w})
    text += ' ' + files::text_of(value);
  text += '\n';
}

std::string header(const char* what) {
  return std::string{"# "} + what + "; north, east, down [m]: timestamp tx ty tz qx qy qz qw\n";
}

}  // namespace

std::string tum_of_estimates(const flight_log::ReplayResult& result) {
  std::string text = header("estimate of gatefly replay");
  for (const auto& row : result.estimates)
    append(text, row.t, row.estimate.p_EB, quaternion_of(row.estimate.attitude));
  return text;
}

std::optional<TumTruth> tum_of_truth(const flight_log::FlightFolder& flight) {
  TumTruth truth{.text = header("truth of a flight's log"), .has_attitude = true};
  bool any = false;
  for (const flight_log::FlightSample& sample : flight.samples) {
    if (!sample.true_p_EB) continue;
    any = true;
    truth.has_attitude = truth.has_attitude && sample.true_attitude;
    append(truth.text, std::chrono::duration<double>(sample.time).count(), *sample.true_p_EB,
           sample.true_attitude ? quaternion_of(*sample.true_attitude) : Quaternion{});
  }
  if (!any) return std::nullopt;
  return truth;
}

std::filesystem::path tum_truth_path(const std::filesystem::path& estimates) {
  std::filesystem::path path = estimates;
  return path.replace_extension().concat(".truth").concat(estimates.extension().string());
}

}  // namespace gatefly::tasks
