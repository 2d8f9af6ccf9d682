// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/mocap_take.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "gatefly/files/csv.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::array kColumns{"t_s", "motive_x_m", "motive_y_m", "motive_z_m",    "qx",
                              "qy",  "qz",         "qw",         "marker_error_m"};
enum Column { kT, kX, kY, kZ, kQx, kQy, kQz, kQw, kError };

// Motive's frame M: x, y up, z. Its body's axes: x left, y up, z along the nose.
const Eigen::Matrix3d& R_EM() {
  static const Eigen::Matrix3d R{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  return R;
}
const Eigen::Matrix3d& R_of_body() {
  static const Eigen::Matrix3d R{{0, -1, 0}, {0, 0, -1}, {1, 0, 0}};
  return R;
}

}  // namespace

MocapTake read_take(const fs::path& path) {
  const files::Csv csv{path};
  std::array<std::vector<double>, kColumns.size()> columns;
  for (std::size_t c = 0; c < kColumns.size(); ++c) columns[c] = csv.numbers(kColumns[c]);
  MocapTake take{.name = path.stem().string()};
  std::array<double, 7> before{};
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    std::array<double, kColumns.size()> v{};
    for (std::size_t c = 0; c < kColumns.size(); ++c) v[c] = columns[c][row];
    // A row without a pose is as good as none.
    if (!std::all_of(v.begin(), v.begin() + kError, [](double x) { return std::isfinite(x); }))
      continue;
    std::array<double, 7> pose{};
    std::copy(v.begin() + kX, v.begin() + kError, pose.begin());
    if (row > 0 && pose == before) {
      ++take.repeated;
      continue;
    }
    before = pose;
    if (!take.samples.empty() && v[kT] <= take.samples.back().t)
      throw std::runtime_error(csv.place(row, "t_s") + ": time does not increase");
    const RotationEB R_EB{R_EM() * rotation_EB(Quaternion{v[kQw], v[kQx], v[kQy], v[kQz]}).matrix *
                          R_of_body()};
    take.samples.push_back({.t = v[kT],
                            .p_E = R_EM() * Eigen::Vector3d{v[kX], v[kY], v[kZ]},
                            .attitude = attitude_of(R_EB)});
    if (std::isfinite(v[kError]))
      take.largest_marker_error = std::max(take.largest_marker_error, v[kError]);
  }
  return take;
}

std::vector<MocapTake> read_takes(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  if (files.empty()) throw std::runtime_error(folder.string() + ": there is no take *.csv in it");
  std::sort(files.begin(), files.end());
  std::vector<MocapTake> takes;
  for (const fs::path& file : files) takes.push_back(read_take(file));
  return takes;
}

}  // namespace gatefly::experiments
