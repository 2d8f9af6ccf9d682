// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/body.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <mujoco/mujoco.h>

#include "gatefly/sim/collisions.hpp"

namespace gatefly::sim {
namespace {

// North-east-down <-> north-west-up.
Eigen::Vector3d flipped(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

std::string xml_of(const Solid& solid) {
  const Eigen::Vector3d c = flipped(solid.center_E), half = 0.5 * solid.size;
  std::ostringstream xml;
  xml << std::setprecision(17) << "<geom name='" << solid.name << "' type='"
      << (solid.pole ? "cylinder" : "box") << "' pos='" << c.x() << ' ' << c.y() << ' ' << c.z()
      << "' size='" << half.x() << ' ';
  if (!solid.pole) xml << half.y() << ' ';
  xml << half.z();
  if (!solid.pole) xml << "' euler='0 0 " << -solid.heading;
  xml << "'/>\n";
  return xml.str();
}

std::string world_xml(const world::SimConfig& config) {
  const world::VehicleTruth& v = config.vehicle;
  std::ostringstream xml;
  xml << std::setprecision(17) << "<mujoco><compiler angle='radian' coordinate='local'/>"
      << "<option timestep='0.0009765625' gravity='0 0 " << -kGravity << "' integrator='Euler'/>"
      << "<size njmax='500' nconmax='100'/><worldbody>\n"
      << "<geom name='floor' type='plane' size='0 0 1'/>\n";
  for (const Solid& solid : solids_of(config.world)) xml << xml_of(solid);
  xml << "<body name='drone' pos='0 0 1'><freejoint name='drone'/><inertial pos='0 0 0' mass='"
      << v.mass << "' diaginertia='" << v.inertia.x() << ' ' << v.inertia.y() << ' '
      << v.inertia.z() << "'/>"
      << "<geom name='drone' type='box' mass='0' friction='1 0.01 0.001' size='" << 0.5 * v.size.x()
      << ' ' << 0.5 * v.size.y() << ' ' << 0.5 * v.size.z()
      << "'/></body>\n</worldbody></mujoco>\n";
  return xml.str();
}

mjModel* load(const std::string& xml) {
  // MuJoCo's reader keeps the last model it read in one place for all threads.
  static std::mutex one_at_a_time;
  const std::lock_guard lock{one_at_a_time};
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
  explicit Mujoco(const world::SimConfig& config)
      : model{load(world_xml(config))}, data{mj_makeData(model)} {
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

Body::Body(const world::SimConfig& config)
    : mujoco_{std::make_unique<Mujoco>(config)}, forces_{config} {
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
  mjModel* m = mujoco_->model;
  mjData* d = mujoco_->data;
  forces_.advance(command, state_, time_, dt);
  state_.rotor_speed = forces_.rotor_speed();
  state_.wind_E = forces_.wind_E();
  const Eigen::Matrix3d R_EB = R_EB_of(state_.q_EB);
  const Eigen::Vector3d force_B = forces_.force_B(R_EB, state_.v_E);
  const Eigen::Vector3d& torque_B = forces_.torque_B();
  const Eigen::Vector3d force = flipped(R_EB * force_B), torque = flipped(R_EB * torque_B);
  double* applied = d->xfrc_applied + 6 * mujoco_->drone_body;
  for (int i = 0; i < 3; ++i) applied[i] = force(i), applied[3 + i] = torque(i);

  const Eigen::Vector3d v_before = state_.v_E;
  m->opt.timestep = dt;
  mj_step(m, d);
  time_ += dt;
  read_state();
  // Specific force from what the body really did, contacts included.
  state_.specific_force_B =
      R_EB.transpose() * ((state_.v_E - v_before) / dt - Eigen::Vector3d{0, 0, kGravity});
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
