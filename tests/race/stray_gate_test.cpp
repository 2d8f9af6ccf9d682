// SPDX-License-Identifier: Apache-2.0
// A gate that stands where the map has none is the one flown to, if that one does not show.
#include "gatefly/race/stray_gate.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"

#include "support/matchers.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
using test::IsNear;

constexpr double kPeriod = 1.0 / 15.0, kSigma = 0.2;
const GateFrame kMap{{6.0, 0.0, -1.5}, 0.2};

GateFrame beside(double right) {
  return {kMap.p_EG + rotation_z(kMap.yaw_EG) * Vector3d{0.0, right, 0.0}, kMap.yaw_EG};
}

StrayGate seen_at(const GateFrame& place, int times) {
  StrayGate stray;
  for (int i = 0; i < times; ++i) stray.seen(place, kSigma, i * kPeriod);
  return stray;
}

TEST(StrayGate, IsTheTargetOnceItWasSeenAtOnePlaceOftenEnough) {
  EXPECT_FALSE(seen_at(beside(2.0), 3).instead_of(kMap));
  const auto place = seen_at(beside(2.0), 7).instead_of(kMap);
  ASSERT_TRUE(place);
  EXPECT_THAT(place->p_EG, IsNear(beside(2.0).p_EG, 1e-9));
  EXPECT_NEAR(place->yaw_EG, kMap.yaw_EG, 1e-9);
}

TEST(StrayGate, IsForgottenWhenTheTargetIsSeen) {
  StrayGate stray = seen_at(beside(2.0), 4);
  stray.target_seen(0);
  EXPECT_TRUE(stray.was_recognised(0));
  EXPECT_FALSE(stray.was_recognised(1));
  stray.seen(beside(2.0), kSigma, 5 * kPeriod);
  EXPECT_FALSE(stray.instead_of(kMap));
}

TEST(StrayGate, IsNotTheTargetWhenItStandsTooFarOffOrFacesElsewhere) {
  EXPECT_FALSE(seen_at(beside(4.0), 20).instead_of(kMap));
  GateFrame across = beside(1.5);
  across.yaw_EG += 1.4;
  EXPECT_FALSE(seen_at(across, 20).instead_of(kMap));
  GateFrame above = beside(0.0);
  above.p_EG.z() -= 1.5;
  EXPECT_FALSE(seen_at(above, 20).instead_of(kMap));
}

TEST(StrayGate, ADroneThatKnowsLittleOfItsOwnPlaceBlamesItself) {
  StrayGate stray;
  for (int i = 0; i < 20; ++i) stray.seen(beside(1.5), 1.0, i * kPeriod);
  EXPECT_FALSE(stray.instead_of(kMap));
  EXPECT_FALSE(seen_at(beside(0.5), 20).instead_of(kMap)) << "what a map may err by";
}

TEST(StrayGate, SightingsOfSeveralPlacesAreOfNoGate) {
  StrayGate stray;
  for (int i = 0; i < 20; ++i) stray.seen(beside(i % 2 == 0 ? -1.5 : 1.5), kSigma, i * kPeriod);
  EXPECT_FALSE(stray.instead_of(kMap));
}

TEST(StrayGate, IsNoGateThatTheMapHasThereAnyway) {
  const std::vector<eskf::Landmark> gates{{kMap.p_EG, kMap.yaw_EG, {}},
                                          {beside(2.0).p_EG, kMap.yaw_EG + 0.7, {}}};
  const eskf::Landmarks map{gates, {}};
  EXPECT_TRUE(is_another_gate(beside(2.4).p_EG, kSigma, map, 0));
  EXPECT_FALSE(is_another_gate(beside(3.5).p_EG, kSigma, map, 0));
  EXPECT_FALSE(is_another_gate(beside(0.3).p_EG, kSigma, map, 0)) << "the target itself";
}

// A filter that believes its map, and looks along x from 4 m before the gate.
eskf::ErrorStateFilter filter_before_the_gate(double right_of_axis) {
  eskf::Setup setup;
  setup.map.push_back({kMap.p_EG, kMap.yaw_EG, {1.0, 0.05}});
  setup.R_BC = camera_mount(0.3).matrix;
  eskf::ErrorStateFilter filter{setup};
  filter.set_target(kMap.p_EG, kMap.yaw_EG);
  filter.start({.p_EB = {2.0, right_of_axis, -1.5}, .rest_accel_B = {}}, 0.0);
  return filter;
}

TEST(StrayGate, TheTargetIsExpectedBeforeTheCameraOnly) {
  const StrayGate stray;
  EXPECT_TRUE(stray.expects_target(filter_before_the_gate(0.0), Vector3d::Zero()));
  EXPECT_FALSE(stray.expects_target(filter_before_the_gate(8.0), Vector3d::Zero()));
}

// Its direction is hardly told by four corners from 4 m away, its place is.
TEST(PlaceOf, FindsAGateThatStandsAsideAndTurned) {
  const eskf::ErrorStateFilter filter = filter_before_the_gate(0.0);
  CameraRig rig{AnyCamera{DhaneFisheye{}}, camera_mount(0.3), {0.1, 0, 0}};
  GateFrame real = beside(1.5);
  real.yaw_EG += 0.2;
  Quad corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d p_E = real.p_EG + rotation_z(real.yaw_EG) * gate_corners_G(1.0)[i];
    const Vector3d p_B = p_E - filter.now().p_EB;  // level, heading 0
    corners[i] = *rig.lens.project(rig.R_BC.matrix.transpose() * (p_B - rig.p_BC));
  }
  const auto place = place_of(corners, 1.0, filter, 0.0, rig, {});
  ASSERT_TRUE(place);
  EXPECT_THAT(place->p_EG, IsNear(real.p_EG, 0.2));
  EXPECT_NEAR(place->yaw_EG, real.yaw_EG, 0.2);
}

TEST(ErrorStateFilter, AReplacedTargetIsWhereItWasPutAndOtherwiseUnknown) {
  eskf::ErrorStateFilter filter = filter_before_the_gate(0.0);
  filter.replace_target({6.0, 2.0, -1.5}, 0.3, 0.3, 0.2);
  EXPECT_THAT(filter.target().p_EG, IsNear(Vector3d{6.0, 2.0, -1.5}, 1e-12));
  EXPECT_NEAR(filter.target_yaw(), 0.3, 1e-12);
  const int gate = eskf::gate_at(filter.target_slot());
  EXPECT_NEAR(filter.sigma(gate), 0.3, 1e-12);
  EXPECT_NEAR(filter.covariance()(gate, eskf::kP), 0.0, 1e-15);
  EXPECT_THAT(filter.covariance(), test::IsCovariance());
}

}  // namespace
}  // namespace gatefly
