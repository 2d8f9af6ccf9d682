// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "gatefly/report/flight_looks.hpp"
#include "gatefly/report/page_course.hpp"
#include "gatefly/report/page_tick.hpp"

namespace gatefly::report {

/// When and how fast each gate was passed: by the truth where it is known, else as the pilot counts.
class GatePasses {
 public:
  /// Every tick. @param now  its time [s].
  void add(const PageTick& tick, const PageCourse& course, double now);

  /// One entry a gate passed, and the next one: where it was seen first, when it was passed.
  /// @param summary  of the same flight: how many count, and by how much they were missed.
  [[nodiscard]] nlohmann::ordered_json json(const PageCourse& course, std::span<const Look> looks,
                                            const nlohmann::ordered_json& summary) const;

 private:
  struct Pass {
    double time = 0.0, speed = 0.0;  ///< [s], [m/s]
  };

  void follow_truth(const PageTick& tick, const world::World& world, double now);
  void follow_pilot(const PageTick& tick, double now);

  std::vector<Pass> passes_;
  std::optional<Eigen::Vector3d> before_;
  double before_time_ = 0.0;  ///< [s]
  int passed_ = 0;            ///< As the pilot counts.
};

}  // namespace gatefly::report
