// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/drawn.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::sim {
namespace {

// Hue turned about the grey axis, in linear light.
Eigen::Vector3d hue_turned(const Eigen::Vector3d& rgb, double angle) {
  if (angle == 0.0) return rgb;
  const auto [s, c] = sincos(angle);
  const Eigen::Vector3d axis = Eigen::Vector3d::Ones() / std::sqrt(3.0);
  const Eigen::Vector3d turned = c * rgb + s * axis.cross(rgb) + (1 - c) * axis * axis.dot(rgb);
  return turned.cwiseMax(0.01).cwiseMin(1.0);
}

Eigen::Vector3d normal3(Stream& stream, double sigma) {
  return {stream.normal_cut(sigma), stream.normal_cut(sigma), stream.normal_cut(sigma)};
}

// Distance on the floor plan from `p` to the straight ways through the gates: decoys keep off them.
double to_lanes(const world::World& world, const Eigen::Vector2d& p) {
  double nearest = 1e9;
  for (const auto& gate : world.gates) {
    const Eigen::Vector2d along{gatefly::cos(gate.yaw_EG), gatefly::sin(gate.yaw_EG)};
    for (double s = -5.0; s <= 3.0; s += 0.25)
      nearest = std::min(nearest, (gate.p_EG.head<2>() + s * along - p).norm());
  }
  return nearest;
}

void add_decoys(world::World& world, int count, Stream& stream) {
  for (int placed = 0, tries = 0; placed < count && tries < 200; ++tries) {
    // Against the walls and well off the lanes: as teams find them, not in their way.
    const Eigen::Vector2d half = 0.5 * world.room_size.head<2>() - Eigen::Vector2d{0.25, 0.25};
    Eigen::Vector2d p{stream.uniform(-half.x(), half.x()), stream.uniform(-half.y(), half.y())};
    const int wall = static_cast<int>(stream.uniform(0, 4));
    if (wall < 2)
      p.x() = wall == 0 ? half.x() : -half.x();
    else
      p.y() = wall == 2 ? half.y() : -half.y();
    p += world.room_center;
    if (to_lanes(world, p) < 1.2) continue;
    world::Decoy decoy;
    decoy.shape.center = p;
    decoy.shape.pole = stream.uniform() < 0.5;
    const double width = stream.uniform(0.1, 0.3);
    decoy.shape.size = decoy.shape.pole ? Eigen::Vector2d{width, width} : Eigen::Vector2d{0.3, 0.3};
    decoy.shape.top = stream.uniform(0.5, 1.8);
    if (!world.gates.empty()) decoy.color = world.gates[0].color;
    world.decoys.push_back(decoy);
    ++placed;
  }
}

/// Whether a point of the floor is that far from every obstacle's footprint.
bool clear_of_obstacles(const world::World& world, const Eigen::Vector2d& p, double distance) {
  return std::none_of(
      world.obstacles.begin(), world.obstacles.end(), [&](const world::WorldBox& box) {
        const auto [s, c] = sincos(box.heading);
        const Eigen::Vector2d away = p - box.center;
        const Eigen::Vector2d own{c * away.x() + s * away.y(), c * away.y() - s * away.x()};
        return (own.cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm() < distance;
      });
}

/// The colour of dark, dull clothes.
Eigen::Vector3d dull_clothes(Stream& stream) {
  const double grey = stream.uniform(0.03, 0.30);
  return {grey * stream.uniform(0.5, 1.3), grey * stream.uniform(0.5, 1.3),
          grey * stream.uniform(0.5, 1.3)};
}

/// Now and then a shirt is red or orange.
Eigen::Vector3d shirt(Stream& stream) {
  const bool warm = stream.uniform() < 0.2;
  const Eigen::Vector3d dull = dull_clothes(stream);
  const Eigen::Vector3d red{stream.uniform(0.35, 0.65), stream.uniform(0.05, 0.25), 0.06};
  return warm ? red : dull;
}

/// People walk along the walls, in front of what stands there, off the lanes and the start.
void add_people(world::World& world, int count, Stream& stream) {
  constexpr double kFromWall = 0.7, kFromLanes = 1.2, kFromThings = 0.35;
  for (int placed = 0, tries = 0; placed < count && tries < 400; ++tries) {
    const int wall = static_cast<int>(stream.uniform(0, 4)), along = wall % 2, across = 1 - along;
    const Eigen::Vector2d half =
        0.5 * world.room_size.head<2>() - Eigen::Vector2d::Constant(kFromWall);
    world::Person person;
    const double length = stream.uniform(2.0, 6.0), middle = stream.uniform(-1.0, 1.0);
    person.speed = stream.uniform(0.3, 1.2);
    person.start = stream.uniform(0.0, 2 * length);
    person.height = stream.uniform(1.55, 1.95);
    person.shirt = shirt(stream), person.trousers = dull_clothes(stream);
    const double room = half[along] - 0.5 * length;
    if (room < 0.0) continue;
    person.from[across] = person.to[across] = wall < 2 ? half[across] : -half[across];
    person.from[along] = middle * room - 0.5 * length;
    person.to[along] = middle * room + 0.5 * length;
    person.from += world.room_center, person.to += world.room_center;
    bool free = true;
    for (double s = 0.0; s <= 1.0 && free; s += 0.1 / length) {
      const Eigen::Vector2d p = person.from + s * (person.to - person.from);
      free = to_lanes(world, p) >= kFromLanes && clear_of_obstacles(world, p, kFromThings);
    }
    if (!free) continue;
    world.people.push_back(person);
    ++placed;
  }
}

/// Gates like the course's own, off its lanes and inside the room, each turned as it likes.
void add_false_gates(world::World& world, int count, Stream& stream) {
  if (world.gates.empty()) return;
  for (int placed = 0, tries = 0; placed < count && tries < 1000; ++tries) {
    world::WorldGate gate = world.gates[static_cast<std::size_t>(placed) % world.gates.size()];
    gate.missing = false, gate.hidden_beyond = 0.0;
    const Eigen::Vector2d half =
        0.5 * world.room_size.head<2>() - Eigen::Vector2d::Constant(0.5 * gate.side + 0.2);
    const Eigen::Vector2d p{stream.uniform(-half.x(), half.x()),
                            stream.uniform(-half.y(), half.y())};
    gate.p_EG.head<2>() = world.room_center + p;
    gate.yaw_EG = stream.uniform(-kPi, kPi);
    if (to_lanes(world, gate.p_EG.head<2>()) < 0.5 * gate.side + 0.8) continue;
    world.false_gates.push_back(gate);
    ++placed;
  }
}

/// A jet across a leg of the course, gate to gate, of a course of one from the start: its axis has
/// one end of the leg on either side, so whoever flies the leg crosses it, by whatever way.
void lay_jet(world::SimConfig& real, double speed) {
  const auto& gates = real.world.gates;
  if (!(speed > 0.0) || gates.empty()) return;
  constexpr double kAslant = 30.0 * kDegree;
  Stream stream{real.seed, "jet"};
  const std::size_t legs = std::max<std::size_t>(gates.size() - 1, 1);
  const auto leg = static_cast<std::size_t>(stream.uniform(0.0, static_cast<double>(legs)));
  const bool from_start = gates.size() == 1;
  const world::WorldGate& to = gates[from_start ? 0 : leg + 1];
  const Eigen::Vector2d from = from_start ? real.start.position : gates[leg].p_EG.head<2>();
  const Eigen::Vector2d way = to.p_EG.head<2>() - from;
  // Two gates in one place are crossed along the second one's plane.
  const double heading = way.isZero() ? to.yaw_EG : gatefly::atan2(way.y(), way.x());
  const double side = stream.uniform() < 0.5 ? -0.5 * kPi : 0.5 * kPi;
  world::Jet& jet = real.wind.jet;
  jet.through = from + stream.uniform(0.25, 0.75) * way;
  jet.heading = wrap_angle(heading + side + stream.uniform(-kAslant, kAslant));
  jet.speed += speed;
}

/// A shear about the middle of all gates.
void lay_shear(world::SimConfig& real, double rate) {
  const auto& gates = real.world.gates;
  if (!(rate > 0.0) || gates.empty()) return;
  Stream stream{real.seed, "shear"};
  world::Shear& shear = real.wind.shear;
  shear.middle.setZero();
  for (const world::WorldGate& gate : gates)
    shear.middle += gate.p_EG.head<2>() / static_cast<double>(gates.size());
  shear.heading = stream.uniform(-kPi, kPi);
  shear.rate += rate;
}

void move_gate(world::SimConfig& real) {
  world::Faults& faults = real.faults;
  auto& gates = real.world.gates;
  if (faults.moved_gate < 0 && !gates.empty()) {
    Stream which{real.seed, "moved gate"};
    faults.moved_gate = 1 + static_cast<int>(which.uniform(0.0, static_cast<double>(gates.size())));
  }
  const auto number = static_cast<std::size_t>(faults.moved_gate);
  if (number < 1 || number > gates.size()) return;
  world::WorldGate& gate = gates[number - 1];
  gate.p_EG +=
      faults.gate_moved + rotation_z(gate.yaw_EG) * Eigen::Vector3d{0, faults.gate_aside, 0};
  gate.yaw_EG += faults.gate_turned;
}

/// The faults that last: they change the truth. Those with a time are left to whom they happen.
void break_it(world::SimConfig& real) {
  const world::Faults& faults = real.faults;
  const auto gate = [&](int number) {
    const bool there = number > 0 && number <= static_cast<int>(real.world.gates.size());
    return there ? &real.world.gates[static_cast<std::size_t>(number - 1)] : nullptr;
  };
  for (world::WorldGate& each : real.world.gates)
    each.p_EG.head<2>() += faults.course_scale * (each.p_EG.head<2>() - real.start.position);
  move_gate(real);
  if (world::WorldGate* missing = gate(faults.missing_gate)) missing->missing = true;
  if (world::WorldGate* hidden = gate(faults.hidden_gate))
    hidden->hidden_beyond = faults.gate_hidden;
  for (world::WorldGate& each : real.world.gates) each.color = hue_turned(each.color, faults.hue);
  Stream stream{real.seed, "false gates"};
  add_false_gates(real.world, faults.false_gates, stream);
  real.light.out = faults.light_out;
  real.vehicle.sag += faults.battery_sag;
  real.vehicle.thrust_coefficient /= 1.0 + faults.hover_thrust;
  real.start.heading += faults.start_heading;
  real.camera.tilt_down += faults.camera_tilt;
  std::visit([&](auto& lens) { lens.focal_px *= 1.0 + faults.focal; }, real.camera.lens.model);
  real.sensors.camera_latency = std::max(0.0, real.sensors.camera_latency + faults.camera_delay);
  real.sensors.frame_loss += faults.camera_drop;
  real.sensors.sonar_loss += faults.sonar_drop;
}

/// A lens that bends otherwise than told: Dhane's k by so much; of the polynomials the first
/// coefficient by a part of itself: a fixed amount would fold a strong barrel back inside the
/// picture. One draw, whatever the lens.
struct LensOff {
  Stream& stream;
  const world::Randomize& sigma;
  void operator()(DhaneFisheye& lens) const { lens.k += stream.normal_cut(sigma.camera_k); }
  void operator()(Pinhole&) const { (void)stream.normal_cut(0.0); }
  void operator()(BrownConrady& lens) const {
    auto distortion = lens.distortion();
    distortion[0] *= 1.0 + stream.normal_cut(sigma.camera_k1);
    lens = {lens.focal_px, lens.center_px, distortion};
  }
  void operator()(KannalaBrandt& lens) const {
    auto coefficients = lens.radial.coefficients();
    coefficients[0] *= 1.0 + stream.normal_cut(sigma.camera_k1);
    lens.radial = RadialPolynomial{coefficients};
  }
};

}  // namespace

world::SimConfig drawn(const world::SimConfig& nominal, const world::Randomize& sigma,
                       std::uint64_t seed) {
  world::SimConfig real = nominal;
  real.seed = seed;

  Stream gates{seed, "gates"};
  Stream light{seed, "light"};
  const double hue = light.normal_cut(sigma.hue);
  for (auto& gate : real.world.gates) {
    gate.p_EG +=
        Eigen::Vector3d{gates.normal_cut(sigma.gate_position),
                        gates.normal_cut(sigma.gate_position), gates.normal_cut(sigma.gate_height)};
    gate.yaw_EG += gates.normal_cut(sigma.gate_heading);
    gate.side *= 1.0 + gates.normal_cut(sigma.gate_side);
    gate.p_EG.z() = std::min(gate.p_EG.z(), -0.5 * gate.side);  // none sinks into the floor
    gate.color = hue_turned(gate.color, hue);
  }
  for (double& gain : real.light.group_gain)
    gain *= std::max(0.1, 1.0 + light.normal_cut(sigma.light));
  real.light.exposure_target *= std::max(0.3, 1.0 + light.normal_cut(sigma.exposure));
  for (double& gain : real.light.white_balance) gain *= 1.0 + light.normal_cut(sigma.white_balance);
  real.light.noise_scale *= sigma.noise_scale;
  Stream colors{seed, "colors"};
  real.camera.imaging.saturation *= std::max(0.2, 1.0 + colors.normal_cut(sigma.saturation));
  Stream decoys{seed, "decoys"};
  add_decoys(real.world, sigma.decoys, decoys);
  Stream people{seed, "people"};
  add_people(real.world, sigma.people, people);

  Stream start{seed, "start"};
  real.start.position += Eigen::Vector2d{start.normal_cut(sigma.start_position),
                                         start.normal_cut(sigma.start_position)};
  real.start.heading += start.normal_cut(sigma.start_heading);

  Stream camera{seed, "camera"};
  const double zoom = 1.0 + camera.normal_cut(sigma.camera_focal);
  const Eigen::Vector2d shift{camera.normal_cut(sigma.camera_center_px),
                              camera.normal_cut(sigma.camera_center_px)};
  std::visit([&](auto& lens) { lens.focal_px *= zoom, lens.center_px += shift; },
             real.camera.lens.model);
  std::visit(LensOff{camera, sigma}, real.camera.lens.model);
  real.camera.tilt_down += camera.normal_cut(sigma.camera_tilt);
  real.sensors.camera_latency =
      std::max(0.0, real.sensors.camera_latency + camera.normal_cut(sigma.camera_latency));
  real.sensors.latency_jitter += sigma.latency_jitter;
  real.sensors.frame_loss += sigma.frame_loss;

  Stream vehicle{seed, "vehicle"};
  real.vehicle.rotor_drag *= 1.0 + vehicle.normal_cut(sigma.drag);
  real.vehicle.body_drag *= 1.0 + vehicle.normal_cut(sigma.drag);
  const double mass = 1.0 + vehicle.normal_cut(sigma.mass);
  real.vehicle.mass *= mass;
  real.vehicle.inertia *= mass;
  real.vehicle.thrust_coefficient *= 1.0 + vehicle.normal_cut(sigma.thrust);
  real.vehicle.sag += sigma.sag;

  Stream bias{seed, "bias"};
  // Drawn in any case: the numbers after it are the same with and without it.
  const Eigen::Vector3d accel_bias = normal3(bias, sigma.accel_bias);
  if (sigma.accel_bias > 0.0) real.sensors.accel_bias = accel_bias;
  real.sensors.flight_bias += normal3(bias, sigma.flight_bias);
  real.sensors.gyro_drift += normal3(bias, sigma.gyro_bias);
  real.sensors.accel_scale += normal3(bias, sigma.scale);
  real.sensors.gyro_scale += normal3(bias, sigma.scale);
  real.sensors.noise_scale *= sigma.noise_scale;

  Stream rotors{seed, "imbalance"};
  for (double& share : real.sensors.imbalance)
    share *= std::max(0.0, 1.0 + rotors.normal_cut(sigma.imbalance));
  Stream warming{seed, "warming"};
  real.sensors.accel_warming += normal3(warming, sigma.accel_warming);
  real.sensors.gyro_warming += normal3(warming, sigma.gyro_warming);
  real.sensors.sonar_loss += sigma.sonar_loss;
  real.sensors.sonar_double += sigma.sonar_double;

  Stream wind{seed, "wind level"};
  real.wind.mean += Eigen::Vector2d{wind.normal_cut(sigma.wind), wind.normal_cut(sigma.wind)};
  real.wind.gust += sigma.gust;
  lay_jet(real, sigma.jet);
  lay_shear(real, sigma.shear);
  real.wind.wash += sigma.wash;
  break_it(real);
  return real;
}

}  // namespace gatefly::sim
