// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/findings.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::eskf {
namespace {

constexpr double kBeyond = 3.0;   // sigmas of the map: 1 in 90 gates of a true one
constexpr double kTwisted = 4.0;  // of its direction, which a few corners from the side tell badly
constexpr double kCertain = 3.0;  // and so many of its own: or nobody has looked

GateOff gate_off(const ErrorStateFilter& filter, int slot) {
  const Landmarks& landmarks = filter.landmarks();
  const Landmark& map = landmarks.map(landmarks.in_slot(slot));
  const GateBelief& belief = filter.now().gates[static_cast<std::size_t>(slot)];
  GateOff off;
  off.gate = landmarks.first_of(landmarks.in_slot(slot));
  off.offset = rotation_z(-map.yaw_EG) * (belief.p_EG - map.p_EG);
  off.turned = wrap_angle(belief.yaw_EG - map.yaw_EG);
  const int at = gate_at(slot);
  off.sigma = std::max(filter.sigma(at), filter.sigma(at + 1));
  off.turned_sigma = filter.sigma(at + kGateYaw);
  return off;
}

// Not as the map may have it, and known well enough.
bool is_off(const GateOff& off, const Priors& priors) {
  const double far = off.offset.head<2>().norm(), turned = std::abs(off.turned);
  const bool moved = far > kBeyond * priors.map && far > kCertain * off.sigma;
  const bool twisted = turned > kTwisted * priors.map_yaw && turned > kCertain * off.turned_sigma;
  return moved || twisted;
}

}  // namespace

Findings findings_of(const ErrorStateFilter& filter) {
  const Nominal& x = filter.now();
  const Eigen::Vector3d mount = turn_of(filter.setup().R_BC.transpose() * x.R_BC);
  Findings found;
  // About the camera's axes, right, down and forward: nose down is negative about the first.
  found.tilt = {-mount.x(), filter.sigma(kMount)};
  found.pan = {mount.y(), filter.sigma(kMount + 1)};
  found.roll = {mount.z(), filter.sigma(kMount + 2)};
  found.delay = {x.delay, filter.sigma(kDelay)};
  found.focal = {x.focal, filter.sigma(kFocal)};
  found.thrust = {x.thrust, filter.sigma(kThrust)};
  found.heading = {x.turned, filter.sigma(kTheta + 2)};
  found.wind_north = {x.wind.x(), filter.sigma(kWind)};
  found.wind_east = {x.wind.y(), filter.sigma(kWind + 1)};
  for (int slot = 0; slot < filter.landmarks().slots(); ++slot)
    (void)found.gates.push_back(gate_off(filter, slot));
  for (const GateOff& gate : found.gates)
    if (is_off(gate, filter.setup().params.priors)) (void)found.off.push_back(gate);
  return found;
}

}  // namespace gatefly::eskf
