// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/camera.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/jpeg_chain.hpp"
#include "gatefly/sim/light_map.hpp"
#include "gatefly/sim/ray_scene.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/sensor.hpp"
#include "gatefly/sim/shading.hpp"

namespace gatefly::sim {
namespace {

constexpr int kSamples = 4;  // per pixel: 12 ms a frame [docs/simulation.md]
constexpr int kPacket = 16;
constexpr int kColumns =
    kPacket / kSamples;  // neighbours of one line that share a packet with all their samples
static_assert(kSamples == 2 * 2, "a grid of them per pixel");
static_assert(kSamples * kColumns == kPacket && sizeof(RayScene::Valid) == kPacket * sizeof(int));
constexpr float kNear = 0.01f;  // the camera sees nothing nearer [m]
constexpr float kFar = 1e3f;
constexpr double kJitter = 0.5;     // of a sample in its cell, 0..1
constexpr float kLampsOut = 0.02f;  // what is left of the light: windows, exit signs
constexpr int kMeterStep = 6;       // one pixel in so many, both ways, meters the first frame

/// Where a sample looks from, single precision.
struct Eye {
  Eigen::Vector3f p_EC;
  Eigen::Matrix3f R_EB;
};

/// Number in [0, 1) by position.
double hashed(std::uint32_t a, std::uint32_t b) {
  std::uint32_t x = a * 0x9E3779B9u ^ (b + 0x7F4A7C15u) * 0x85EBCA6Bu;
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return (x ^ (x >> 16)) * 0x1p-32;
}

Eye eye_of(const BodyPose& pose, const Eigen::Vector3d& p_BC) {
  const double norm = pose.q_EB.norm();
  const Eigen::Vector4d q =
      norm > 0.0 ? Eigen::Vector4d{pose.q_EB / norm} : Eigen::Vector4d{1, 0, 0, 0};
  const Eigen::Matrix3d R_EB = R_EB_of(q);
  return {(pose.p_EB + R_EB * p_BC).cast<float>(), R_EB.cast<float>()};
}

using Eyes = std::array<Eye, kSamples>;

/// A packet's directions in the body frame, lane = sample * kColumns + pixel; not valid outside the
/// lens's field of view. All samples of a few neighbours are closer together than one of many.
struct alignas(64) Directions {
  float x[kPacket], y[kPacket], z[kPacket];
  RayScene::Valid valid;
};

}  // namespace

struct CameraRenderer::Impl {
  Impl(const World& world, const CameraTruth& truth, const LightConditions& light,
       std::uint64_t seed, const std::filesystem::path& cache_dir, int bake_threads)
      : camera{truth},
        scene{make_scene(world)},
        visible{{&scene.fixed, &scene.moved}, scene.walkers_at(0.0).size()},
        lamps_out{light.out},
        solid{{&scene.solid}, scene.walkers_at(0.0).size()},
        shader{lit(light, cache_dir, bake_threads)},
        sensor{truth, light, seed},
        packets{(truth.stored_width + kColumns - 1) / kColumns},
        picture(static_cast<std::size_t>(truth.stored_width) *
                static_cast<std::size_t>(truth.stored_height)) {
    make_directions();
    for (std::size_t i = 0; i < world.gates.size(); ++i)
      if (world.gates[i].hidden_beyond > 0.0) hide(static_cast<int>(i), world.gates[i]);
  }

  /// The scene without a gate, for as long as it is far away. Its rectangles stay in the list, of
  /// no size: hits keep their numbers.
  void hide(int gate, const WorldGate& where) {
    std::vector<Rectangle> moved = scene.moved;
    for (Rectangle& r : moved)
      if (r.gate == gate) r.edge_u.setZero(), r.edge_v.setZero();
    hidden_gate = where;
    without_gate =
        std::make_unique<RayScene>(std::vector<const std::vector<Rectangle>*>{&scene.fixed, &moved},
                                   scene.walkers_at(0.0).size());
  }
  /// Puts people where they are at that time.
  void walk(double t) {
    if (scene.walkers.empty()) return;
    const std::vector<Rectangle> people = scene.walkers_at(t);
    visible.move(people);
    solid.move(people);
    if (without_gate) without_gate->move(people);
  }
  /// What there is to be seen from there.
  [[nodiscard]] const RayScene& seen_from(const Eigen::Vector3d& p_E) const {
    const bool hidden = without_gate && (hidden_gate.p_EG - p_E).norm() > hidden_gate.hidden_beyond;
    return hidden ? *without_gate : visible;
  }

  Shader lit(const LightConditions& light, const std::filesystem::path& cache_dir, int threads);
  void make_directions();
  [[nodiscard]] Eyes eyes(double t_start, std::span<const BodyPose> history, int line) const;
  void cast(const Eyes& eyes, const Directions& d, RTCRayHit16& packet, Float4* pixels) const;
  void render_line(double t_start, std::span<const BodyPose> history, int line);
  void meter(double t_start, std::span<const BodyPose> history);

  CameraTruth camera;
  Scene scene;
  RayScene visible;
  During lamps_out;
  WorldGate hidden_gate;
  std::unique_ptr<RayScene> without_gate;
  const RayScene* now_visible = &visible;
  float brightness = 1.0f;  ///< Of all lamps, in this frame.
  RayScene solid;
  double bake_seconds = 0.0;
  Shader shader;
  Sensor sensor;
  int packets;
  bool metered = false;
  std::vector<Directions> table;
  std::vector<Float4> picture;
};

Shader CameraRenderer::Impl::lit(const LightConditions& light,
                                 const std::filesystem::path& cache_dir, int threads) {
  const RayScene fixed{{&scene.fixed}};
  const LightMap map = fixed_light(scene, fixed, cache_dir, threads);
  bake_seconds = map.bake_seconds;
  return {scene, map, moved_light(scene, fixed, map), light};
}

void CameraRenderer::Impl::make_directions() {
  const Eigen::Matrix3d R_BC = camera_mount(camera.tilt_down).matrix;
  table.assign(static_cast<std::size_t>(camera.stored_height * packets), Directions{});
  for (int line = 0; line < camera.stored_height; ++line) {
    for (int x = 0; x < camera.stored_width; ++x) {
      for (int sample = 0; sample < kSamples; ++sample) {
        // A jittered 2 x 2 grid; the stored picture is turned.
        const auto pixel = static_cast<std::uint32_t>(line * camera.stored_width + x);
        const auto place = [&](int cell, int key) {
          const double jitter = kJitter * (hashed(pixel, static_cast<std::uint32_t>(key)) - 0.5);
          return ((cell + 0.5 + jitter) / 2 - 0.5) * camera.imaging.footprint_px;
        };
        const double du = place(sample % 2, 2 * sample), dv = place(sample / 2, 2 * sample + 1);
        const auto bearing_C =
            camera.lens.bearing(camera.upright(x, line) + Eigen::Vector2d{du, dv});
        if (!bearing_C) continue;
        const Eigen::Vector3f bearing_B = (R_BC * *bearing_C).cast<float>();
        Directions& d = table[static_cast<std::size_t>(line * packets + x / kColumns)];
        const int lane = sample * kColumns + x % kColumns;
        d.x[lane] = bearing_B.x(), d.y[lane] = bearing_B.y(), d.z[lane] = bearing_B.z();
        d.valid.lane[lane] = -1;
      }
    }
  }
}

Eyes CameraRenderer::Impl::eyes(double t_start, std::span<const BodyPose> history, int line) const {
  const double share =
      camera.stored_height > 1 ? static_cast<double>(line) / (camera.stored_height - 1) : 0.0;
  // Each line deals its quarters of the exposure to the samples anew: blur without a fixed pattern.
  const auto key = static_cast<std::uint32_t>(line);
  Eyes result;
  for (int sample = 0; sample < kSamples; ++sample) {
    const int quarter = (sample + static_cast<int>(kSamples * hashed(key, 91))) % kSamples;
    const double within =
        (quarter + hashed(key, 92u + static_cast<std::uint32_t>(sample))) / kSamples;
    const double t = t_start + camera.readout * share + sensor.exposure() * within;
    result[static_cast<std::size_t>(sample)] = eye_of(interpolated(history, t), camera.p_BC);
  }
  return result;
}

void CameraRenderer::Impl::cast(const Eyes& eyes, const Directions& d, RTCRayHit16& packet,
                                Float4* pixels) const {
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto& [p, R] = eyes[static_cast<std::size_t>(sample)];
    for (int i = sample * kColumns; i < (sample + 1) * kColumns; ++i) {
      packet.ray.org_x[i] = p.x(), packet.ray.org_y[i] = p.y(), packet.ray.org_z[i] = p.z();
      packet.ray.dir_x[i] = R(0, 0) * d.x[i] + R(0, 1) * d.y[i] + R(0, 2) * d.z[i];
      packet.ray.dir_y[i] = R(1, 0) * d.x[i] + R(1, 1) * d.y[i] + R(1, 2) * d.z[i];
      packet.ray.dir_z[i] = R(2, 0) * d.x[i] + R(2, 1) * d.y[i] + R(2, 2) * d.z[i];
      packet.ray.tnear[i] = kNear, packet.ray.tfar[i] = kFar;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
  }
  now_visible->intersect(d.valid, packet, RayScene::Rays::kCoherent);
  std::fill_n(pixels, kColumns, Float4{});
  for (int i = 0; i < kPacket; ++i) {
    if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    const unsigned hit = packet.hit.primID[i];
    const Eigen::Vector3f& n = shader.normal(hit);
    const float facing =
        n.x() * packet.ray.dir_x[i] + n.y() * packet.ray.dir_y[i] + n.z() * packet.ray.dir_z[i];
    if (facing < 0.0f)
      pixels[i % kColumns] +=
          (brightness / kSamples) * shader.radiance(hit, packet.hit.u[i], packet.hit.v[i]);
  }
}

void CameraRenderer::Impl::render_line(double t_start, std::span<const BodyPose> history,
                                       int line) {
  const Eyes from = eyes(t_start, history, line);
  RTCRayHit16 packet{};
  for (int p = 0; p < packets; ++p) {
    std::array<Float4, kColumns> pixels;
    cast(from, table[static_cast<std::size_t>(line * packets + p)], packet, pixels.data());
    std::copy_n(pixels.begin(), std::min(kColumns, camera.stored_width - p * kColumns),
                picture.begin() + line * camera.stored_width + p * kColumns);
  }
}

void CameraRenderer::Impl::meter(double t_start, std::span<const BodyPose> history) {
  std::vector<Float4> radiances;
  for (int line = 0; line < camera.stored_height; line += kMeterStep) {
    render_line(t_start, history, line);
    for (int x = 0; x < camera.stored_width; x += kMeterStep)
      radiances.push_back(picture[static_cast<std::size_t>(line * camera.stored_width + x)]);
  }
  sensor.meter(radiances);
}

BodyPose interpolated(std::span<const BodyPose> history, double t) {
  if (history.empty()) return {};
  const auto after =
      std::upper_bound(history.begin(), history.end(), t,
                       [](double time, const BodyPose& pose) { return time < pose.t; });
  if (after == history.begin()) return history.front();
  if (after == history.end()) return history.back();
  const BodyPose& one = *(after - 1);
  const BodyPose& two = *after;
  const double s = (t - one.t) / (two.t - one.t), sign = one.q_EB.dot(two.q_EB) < 0.0 ? -1.0 : 1.0;
  return {t, one.p_EB + s * (two.p_EB - one.p_EB), one.q_EB + s * (sign * two.q_EB - one.q_EB)};
}

CameraRenderer::CameraRenderer(const World& world, const CameraTruth& camera,
                               const LightConditions& light, std::uint64_t seed,
                               const std::filesystem::path& cache_dir, int bake_threads)
    : impl_{std::make_unique<Impl>(world, camera, light, seed, cache_dir, bake_threads)} {}

CameraRenderer::~CameraRenderer() = default;

void CameraRenderer::render(std::uint32_t frame, double t_start, std::span<const BodyPose> history,
                            std::vector<std::uint8_t>& uyvy) {
  impl_->now_visible = &impl_->seen_from(interpolated(history, t_start).p_EB);
  impl_->walk(t_start);
  impl_->brightness = within(impl_->lamps_out, t_start) ? kLampsOut : 1.0f;
  if (!impl_->metered) impl_->meter(t_start, history);
  impl_->metered = true;
  for (int line = 0; line < impl_->camera.stored_height; ++line)
    impl_->render_line(t_start, history, line);
  impl_->sensor.develop(frame, t_start, impl_->picture, uyvy);
  if (impl_->camera.jpeg_quality > 0)
    through_jpeg(uyvy, impl_->camera.stored_width, impl_->camera.stored_height,
                 impl_->camera.jpeg_quality);
}

void CameraRenderer::meter_anew() { impl_->metered = false; }

std::vector<std::uint8_t> CameraRenderer::gate_mask(double t_start,
                                                    std::span<const BodyPose> history) const {
  const CameraTruth& camera = impl_->camera;
  const int width = camera.width(), height = camera.height();
  const RayScene& visible = impl_->seen_from(interpolated(history, t_start).p_EB);
  const Eigen::Matrix3f R_BC = camera_mount(camera.tilt_down).matrix.cast<float>();
  const std::size_t fixed = impl_->scene.fixed.size();
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(width * height));
  for (int line = 0; line < camera.stored_height; ++line) {
    const double share =
        camera.stored_height > 1 ? static_cast<double>(line) / (camera.stored_height - 1) : 0.0;
    const double t = t_start + camera.readout * share + 0.5 * impl_->sensor.exposure();
    const Eye eye = eye_of(interpolated(history, t), camera.p_BC);
    for (int x = 0; x < camera.stored_width; ++x) {
      const Eigen::Vector2d px = camera.upright(x, line);
      const auto bearing_C = camera.lens.bearing(px);
      if (!bearing_C) continue;
      const Eigen::Vector3f d = eye.R_EB * (R_BC * bearing_C->cast<float>());
      RTCRayHit ray{};
      ray.ray.org_x = eye.p_EC.x(), ray.ray.org_y = eye.p_EC.y(), ray.ray.org_z = eye.p_EC.z();
      ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
      ray.ray.tnear = kNear, ray.ray.tfar = kFar;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      visible.intersect(ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID || ray.hit.primID < fixed) continue;
      const Rectangle& hit = impl_->scene.moved[ray.hit.primID - fixed];
      if (hit.bar)
        mask[static_cast<std::size_t>(std::lround(px.y()) * width + std::lround(px.x()))] =
            static_cast<std::uint8_t>(hit.gate < 0 ? 255 : std::min(hit.gate + 1, 254));
    }
  }
  return mask;
}

bool CameraRenderer::occluded(const Eigen::Vector3d& from_E, const Eigen::Vector3d& to_E) const {
  const Eigen::Vector3f from = from_E.cast<float>(), d = (to_E - from_E).cast<float>();
  RTCRay ray{};
  ray.org_x = from.x(), ray.org_y = from.y(), ray.org_z = from.z();
  ray.dir_x = d.x(), ray.dir_y = d.y(), ray.dir_z = d.z();
  ray.tfar = 0.999f;  // the point itself may lie on something
  impl_->solid.occluded(ray);
  return ray.tfar < 0.0f;
}

double CameraRenderer::range(const Eigen::Vector3d& from_E, const Eigen::Vector3d& direction_E,
                             double max) const {
  const Eigen::Vector3f from = from_E.cast<float>(), d = direction_E.cast<float>();
  RTCRayHit ray{};
  ray.ray.org_x = from.x(), ray.ray.org_y = from.y(), ray.ray.org_z = from.z();
  ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
  ray.ray.tfar = static_cast<float>(max);
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  impl_->solid.intersect(ray);
  return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? max : static_cast<double>(ray.ray.tfar);
}

double CameraRenderer::bake_seconds() const { return impl_->bake_seconds; }

}  // namespace gatefly::sim
