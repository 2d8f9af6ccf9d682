// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/body.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include <mujoco/mujoco.h>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::sim {
namespace {

constexpr double kGravity = 9.81;

// North-east-down <-> north-west-up.
Eigen::Vector3d flipped(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

std::string box_xml(const std::string& name, const Eigen::Vector3d& center_E, const Eigen::Vector3d& size,
                    double heading) {
  const Eigen::Vector3d c = flipped(center_E);
  std::ostringstream xml;
  xml << std::setprecision(17) << "<geom name='" << name << "' type='box' pos='" << c.x() << ' ' << c.y() << ' '
      << c.z() << "' size='" << 0.5 * size.x() << ' ' << 0.5 * size.y() << ' ' << 0.5 * size.z() << "' euler='0 0 "
      << -heading << "'/>\n";
  return xml.str();
}

std::string pole_xml(const std::string& name, const Eigen::Vector2d& center, double radius, double bottom,
                     double top) {
  std::ostringstream xml;
  xml << std::setprecision(17) << "<geom name='" << name << "' type='cylinder' pos='" << center.x() << ' '
      << -center.y() << ' ' << 0.5 * (bottom + top) << "' size='" << radius << ' ' << 0.5 * (top - bottom) << "'/>\n";
  return xml.str();
}

std::string solid_xml(const std::string& name, const WorldBox& box) {
  if (box.pole) return pole_xml(name, box.center, 0.5 * box.size.x(), box.bottom, box.top);
  return box_xml(name, {box.center.x(), box.center.y(), -0.5 * (box.bottom + box.top)},
                 {box.size.x(), box.size.y(), box.top - box.bottom}, box.heading);
}

std::string gate_xml(const std::string& name, const WorldGate& gate) {
  const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
  const double off = 0.5 * (gate.side - gate.bar);
  std::string xml;
  const auto bar = [&](const char* which, double y, double z, double width, double height) {
    xml += box_xml(name + " " + which, gate.p_EG + R_EG * Eigen::Vector3d{0, y, z}, {gate.bar, width, height},
                   gate.yaw_EG);
  };
  bar("left bar", -off, 0, gate.bar, gate.side);
  bar("right bar", off, 0, gate.bar, gate.side);
  bar("upper bar", 0, -off, gate.side, gate.bar);
  bar("lower bar", 0, off, gate.side, gate.bar);
  const double below = -gate.p_EG.z() - 0.5 * gate.side;
  if (below > 0.02) xml += pole_xml(name + " pole", gate.p_EG.head<2>(), 0.02, 0.0, below);
  return xml;
}

std::string world_xml(const SimConfig& config) {
  const World& world = config.world;
  const VehicleTruth& v = config.vehicle;
  std::ostringstream xml;
  xml << std::setprecision(17) << "<mujoco><compiler angle='radian' coordinate='local'/>"
      << "<option timestep='0.0009765625' gravity='0 0 " << -kGravity << "' integrator='Euler'/>"
      << "<size njmax='500' nconmax='100'/><worldbody>\n"
      << "<geom name='floor' type='plane' size='0 0 1'/>\n";
  const double h = world.room_size.z();
  const Eigen::Vector2d c = world.room_center;
  const double half_x = 0.5 * world.room_size.x(), half_y = 0.5 * world.room_size.y();
  xml << box_xml("north wall", {c.x() + half_x + 0.1, c.y(), -0.5 * h}, {0.2, 2 * half_y, h}, 0)
      << box_xml("south wall", {c.x() - half_x - 0.1, c.y(), -0.5 * h}, {0.2, 2 * half_y, h}, 0)
      << box_xml("east wall", {c.x(), c.y() + half_y + 0.1, -0.5 * h}, {2 * half_x, 0.2, h}, 0)
      << box_xml("west wall", {c.x(), c.y() - half_y - 0.1, -0.5 * h}, {2 * half_x, 0.2, h}, 0)
      << box_xml("ceiling", {c.x(), c.y(), -h - 0.1}, {2 * half_x, 2 * half_y, 0.2}, 0);
  for (std::size_t i = 0; i < world.gates.size(); ++i)
    xml << gate_xml("gate " + std::to_string(i + 1), world.gates[i]);
  for (std::size_t i = 0; i < world.obstacles.size(); ++i)
    xml << solid_xml("obstacle " + std::to_string(i + 1), world.obstacles[i]);
  for (std::size_t i = 0; i < world.decoys.size(); ++i)
    xml << solid_xml("decoy " + std::to_string(i + 1), world.decoys[i].shape);
  xml << "<body name='drone' pos='0 0 1'><freejoint name='drone'/><inertial pos='0 0 0' mass='" << v.mass
      << "' diaginertia='" << v.inertia.x() << ' ' << v.inertia.y() << ' ' << v.inertia.z() << "'/>"
      << "<geom name='drone' type='box' mass='0' friction='1 0.01 0.001' size='" << 0.5 * v.size.x() << ' '
      << 0.5 * v.size.y() << ' ' << 0.5 * v.size.z() << "'/></body>\n</worldbody></mujoco>\n";
  return xml.str();
}

mjModel* load(const std::string& xml) {
  // MuJoCo 2.2 reads from a virtual file system without touching the disk.
  auto vfs = std::make_unique<mjVFS>();
  mj_defaultVFS(vfs.get());
  const int size = static_cast<int>(xml.size());
  mj_makeEmptyFileVFS(vfs.get(), "world.xml", size);
  std::copy(xml.begin(), xml.end(), static_cast<char*>(vfs->filedata[0]));
  char error[500] = "";
  mjModel* model = mj_loadXML("world.xml", vfs.get(), error, sizeof error);
  mj_deleteVFS(vfs.get());
  if (model == nullptr) throw std::runtime_error(std::string("simulator world: ") + error);
  return model;
}

}  // namespace

struct Body::Mujoco {
  explicit Mujoco(const SimConfig& config) : model{load(world_xml(config))}, data{mj_makeData(model)} {
    drone_body = mj_name2id(model, mjOBJ_BODY, "drone");
    drone_geom = mj_name2id(model, mjOBJ_GEOM, "drone");
  }
  ~Mujoco() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  mjModel* model;
  mjData* data;
  int drone_body = 0, drone_geom = 0;
};

Body::Body(const SimConfig& config)
    : config_{config}, mujoco_{std::make_unique<Mujoco>(config)}, wind_stream_{config.seed, "wind"} {
  double* q = mujoco_->data->qpos;
  q[0] = config.start.position.x();
  q[1] = -config.start.position.y();
  q[2] = 0.5 * config.vehicle.size.z();
  const Quaternion heading = quaternion_of({0, 0, -config.start.heading});
  q[3] = heading.w, q[4] = heading.x, q[5] = heading.y, q[6] = heading.z;
  mj_forward(mujoco_->model, mujoco_->data);
  read_state();
}

Body::~Body() = default;

void Body::read_state() {
  const mjData* d = mujoco_->data;
  state_.p_EB = flipped({d->qpos[0], d->qpos[1], d->qpos[2]});
  state_.v_E = flipped({d->qvel[0], d->qvel[1], d->qvel[2]});
  // The same turn by π about x on both sides: (w, x, y, z) -> (w, x, -y, -z).
  state_.q_EB = {d->qpos[3], d->qpos[4], -d->qpos[5], -d->qpos[6]};
  state_.rate_B = flipped({d->qvel[3], d->qvel[4], d->qvel[5]});
}

void Body::step(const std::array<double, 4>& command, double dt) {
  const VehicleTruth& v = config_.vehicle;
  mjModel* m = mujoco_->model;
  mjData* d = mujoco_->data;

  // Rotors follow with a lag; thrust and yaw torque go with speed².
  const double sag = 1.0 - v.sag * std::min(1.0, time_ / v.sag_time);
  const double lag = std::min(1.0, dt / v.rotor_time_constant);
  double total = 0.0, spin = 0.0;
  Eigen::Vector3d torque_B = Eigen::Vector3d::Zero();
  constexpr std::array<double, 4> kX{1, 1, -1, -1}, kY{-1, 1, 1, -1}, kYaw{-1, 1, -1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    double& speed = state_.rotor_speed[i];
    const double wanted = std::isfinite(command[i]) ? std::clamp(command[i], v.min_speed, v.max_speed) : 0.0;
    speed += lag * (wanted - speed);
    const double thrust = sag * v.thrust_coefficient * speed * speed;
    torque_B += Eigen::Vector3d{-kY[i] * v.arm_y * thrust, kX[i] * v.arm_x * thrust,
                                kYaw[i] * v.torque_coefficient * thrust};
    total += thrust;
    spin += 0.25 * speed;
  }

  // Drag: in the rotor plane proportional to rotor speed, and of the body with speed².
  const Eigen::Matrix3d R_EB =
      rotation_EB(Quaternion{state_.q_EB(0), state_.q_EB(1), state_.q_EB(2), state_.q_EB(3)}).matrix;
  if (config_.wind.gust > 0.0) {
    const double keep = 1.0 - dt;  // 1 s correlation
    const double push = config_.wind.gust * std::sqrt(2.0 * dt);
    gust_ = keep * gust_ + push * Eigen::Vector2d{wind_stream_.normal(), wind_stream_.normal()};
  }
  const Eigen::Vector2d wind = config_.wind.mean + gust_;
  const Eigen::Vector3d air_B = R_EB.transpose() * (state_.v_E - Eigen::Vector3d{wind.x(), wind.y(), 0});
  const double hover_speed = std::sqrt(v.mass * kGravity / 4 / v.thrust_coefficient);
  const Eigen::Vector3d drag_B = v.mass * ((spin / hover_speed) * v.rotor_drag.cwiseProduct(air_B) -
                                           v.body_drag * air_B.norm() * air_B);
  const Eigen::Vector3d force_B = Eigen::Vector3d{0, 0, -total} + drag_B;

  const Eigen::Vector3d force = flipped(R_EB * force_B), torque = flipped(R_EB * torque_B);
  double* applied = d->xfrc_applied + 6 * mujoco_->drone_body;
  for (int i = 0; i < 3; ++i) applied[i] = force(i), applied[3 + i] = torque(i);

  const Eigen::Vector3d v_before = state_.v_E;
  m->opt.timestep = dt;
  mj_step(m, d);
  time_ += dt;
  read_state();
  // Specific force from what the body really did, contacts included.
  state_.specific_force_B = R_EB.transpose() * ((state_.v_E - v_before) / dt - Eigen::Vector3d{0, 0, kGravity});
}

std::optional<std::string> Body::contact() const {
  const mjData* d = mujoco_->data;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (contact.dist > 0) continue;
    int other = -1;
    if (contact.geom1 == mujoco_->drone_geom) other = contact.geom2;
    if (contact.geom2 == mujoco_->drone_geom) other = contact.geom1;
    if (other < 0) continue;
    const char* name = mj_id2name(mujoco_->model, mjOBJ_GEOM, other);
    return name == nullptr ? "something" : name;
  }
  return std::nullopt;
}

}  // namespace gatefly::sim
