// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gatefly/flight_log/baseline/imu15.hpp"

#include "support/allocation_counter.hpp"

namespace gatefly::baseline {
namespace {

// Else its cost beside the drag filter's would be malloc's. The drag filter:
// Pilot.AllocatesNothingOnceBuilt.
TEST(Imu15, NeverAllocates) {
  Imu15 filter{{}};
  {
    const test::NothingAllocated guard;
    filter.start({0, 0, -1}, {}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    for (int i = 1; i < 1000; ++i) {
      filter.predict({.gyro_B = {0.1, 0, 0}, .accel_B = {0, 0.1, -9.81}}, 1.0 / 512);
      if (i % 34 == 0)
        filter.correct_position({0, 0, -1}, {0.1, 0.1, 0.1}), filter.correct_altitude(-1, 0.05),
            filter.correct_heading(0, 0.02);
    }
  }
  test::expect_that_allocations_are_counted();
}

}  // namespace
}  // namespace gatefly::baseline
