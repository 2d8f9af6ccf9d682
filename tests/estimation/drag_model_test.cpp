// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/drag_model.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/central_difference.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using drag_model::Input;
using drag_model::State;
using Eigen::Vector3d;

TEST(DragModel, JacobianMatchesCentralDifferences) {
  for_all(200, [](Rng& rng) {
    const State x = any_state(rng);
    const Input u = any_input(rng);
    const auto f = [&](const State& s) { return drag_model::derivative(s, u, {}); };
    EXPECT_THAT(drag_model::jacobian(x, u, {}), IsNear(central_difference(f, x), 1e-6));
  });
}

TEST(DragModel, HoverStandsStill) {
  Input u;
  u.accel_B = {0, 0, -9.81};
  EXPECT_THAT(drag_model::derivative(State::Zero(), u, {}), IsNear(State::Zero(), 1e-12));
}

TEST(DragModel, HoverWithABiasThatIsKnownStandsStillToo) {
  for_all(200, [](Rng& rng) {
    State x = State::Zero();
    x.segment<3>(drag_model::kBiasX) = any_vector3(rng, 0.5);
    Input u;
    u.accel_B = Vector3d{0, 0, -9.81} + x.segment<3>(drag_model::kBiasX);
    u.yaw = rng.uniform(-3, 3);
    EXPECT_THAT(drag_model::derivative(x, u, {}), IsNear(State::Zero(), 1e-12));
  });
}

// Level flight at constant speed, nose down: drag along x and gravity balance there, so a_x = g
// sin(pitch).
TEST(DragModel, SteadyFlightHasTheSpeedThatDragBalances) {
  const drag_model::Params params;
  const double pitch = -5 * kDegree, yaw = 0.4, g = params.gravity, k = params.drag.x();
  // Without drag along z: m v̇ = 0 in B: k v_x - g sin θ = 0, v_z = v_x tan θ is what keeps it
  // level.
  const double v_x = g * std::sin(pitch) / k;
  State x = State::Zero();
  x(drag_model::kVz) = v_x * std::tan(pitch);
  Input u;
  u.pitch = pitch, u.yaw = yaw;
  u.accel_B = {k * v_x, 0, -g * std::cos(pitch)};
  const State dx = drag_model::derivative(x, u, params);
  EXPECT_GT(v_x, 1.5);
  EXPECT_NEAR(dx(drag_model::kZ), 0, 1e-12) << "level";
  EXPECT_NEAR(dx(drag_model::kVz), 0, 1e-12);
  const double ground_speed = v_x / std::cos(pitch);
  EXPECT_NEAR(dx(drag_model::kX), ground_speed * std::cos(yaw), 1e-12);
  EXPECT_NEAR(dx(drag_model::kY), ground_speed * std::sin(yaw), 1e-12);
}

TEST(DragModel, AMirroredFlightHasTheMirroredDerivative) {
  for_all(200, [](Rng& rng) {
    const State x = any_state(rng);
    const Input u = any_input(rng);
    State m;
    m << x(0), -x(1), x(2), x(3), x(4), -x(5), x(6);
    Input n = u;
    n.roll *= -1, n.yaw *= -1;
    n.accel_B.y() *= -1;
    n.gyro_B.x() *= -1, n.gyro_B.z() *= -1;
    const State a = drag_model::derivative(x, u, {}), b = drag_model::derivative(m, n, {});
    State a_mirrored = a;
    a_mirrored(1) *= -1, a_mirrored(5) *= -1;
    EXPECT_THAT(b, IsNear(a_mirrored, 1e-12));
  });
}

TEST(DragModel, WherePositionIsCountedFromDoesNotMatter) {
  for_all(200, [](Rng& rng) {
    const State x = any_state(rng);
    const Input u = any_input(rng);
    State shifted = x;
    shifted.head<3>() += any_vector3(rng, 100);
    EXPECT_EQ(drag_model::derivative(x, u, {}), drag_model::derivative(shifted, u, {}));
  });
}

}  // namespace
}  // namespace gatefly
