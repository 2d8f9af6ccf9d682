// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "gatefly/baseline/imu15.hpp"

// Every allocation of this program is counted. Not inlined: GCC would warn about new meeting free().
namespace {
std::atomic<long> allocations{0};
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size != 0 ? size : 1)) return p;
  throw std::bad_alloc{};
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace gatefly::baseline {
namespace {

// Else its cost beside the drag filter's would be malloc's. The drag filter: Pilot.AllocatesNothingOnceBuilt.
TEST(Imu15, NeverAllocates) {
  Imu15 filter{{}};
  const long before = allocations;
  filter.start({0, 0, -1}, {}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  for (int i = 1; i < 1000; ++i) {
    filter.predict({.gyro_B = {0.1, 0, 0}, .accel_B = {0, 0.1, -9.81}}, 1.0 / 512);
    if (i % 34 == 0) filter.correct_position({0, 0, -1}, {0.1, 0.1, 0.1}), filter.correct_altitude(-1, 0.05), filter.correct_heading(0, 0.02);
  }
  EXPECT_EQ(allocations - before, 0);
  const long counted = allocations;
  operator delete(operator new(8));
  EXPECT_GT(allocations, counted) << "the counter counts";
}

}  // namespace
}  // namespace gatefly::baseline
