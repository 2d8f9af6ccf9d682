// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/late_line.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace gatefly::sim {
namespace {

TEST(LateLine, MessagesArriveInOrderNoneBeforeItsDelayAndNoneIsLost) {
  constexpr double kDelay = 0.02;
  LateLine<int> line{100.0, kDelay, 0.03, {1, "autopilot link"}};
  std::vector<double> sent;
  int next = 0, late = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const double time = 0.001 * tick;
    if (tick < 3000 && line.is_due(time)) {
      line.send(static_cast<int>(sent.size()), time);
      sent.push_back(time);
    }
    while (const auto message = line.arrived(time)) {
      EXPECT_EQ(*message, next++);
      const double on_its_way = time - sent[static_cast<std::size_t>(*message)];
      EXPECT_GE(on_its_way, kDelay - 1e-9);
      late += on_its_way > kDelay + 0.01;
    }
  }
  EXPECT_EQ(next, static_cast<int>(sent.size()));
  EXPECT_NEAR(static_cast<double>(sent.size()), 300.0, 1.0);
  EXPECT_GT(late, 100) << "the jitter shows";
}

}  // namespace
}  // namespace gatefly::sim
