// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/camera.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/jpeg_chain.hpp"
#include "gatefly/sim/lens_rays.hpp"
#include "gatefly/sim/light_map.hpp"
#include "gatefly/sim/ray_scene.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/sensor.hpp"
#include "gatefly/sim/shading.hpp"
#include "gatefly/sim/tile_caster.hpp"

namespace gatefly::sim {
namespace {

constexpr int kSamples = 4;         // per pixel [docs/simulation.md]
constexpr float kLampsOut = 0.02f;  // what is left of the light: windows, exit signs
constexpr int kMeterStep = 6;       // one pixel in so many, both ways, meters the first frame

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

}  // namespace

struct CameraRenderer::Impl {
  Impl(const world::World& world, const world::CameraTruth& truth,
       const world::LightConditions& light, std::uint64_t seed,
       const std::filesystem::path& cache_dir, int bake_threads,
       const std::function<void()>& while_baking)
      : camera{truth},
        scene{make_scene(world)},
        standing{scene.moved.begin(),
                 scene.moved.end() - static_cast<std::ptrdiff_t>(scene.walkers_at(0.0).size())},
        visible{{&scene.fixed, &standing}},
        lamps_out{light.out},
        solid{{&scene.solid}, scene.walkers_at(0.0).size()},
        shader{lit(light, cache_dir, bake_threads, while_baking)},
        sensor{truth, light, seed},
        pixels{truth,
               {.samples = truth.fast ? 1 : kSamples,
                .footprint = light.blur * truth.imaging.footprint_px}},
        centres{truth, {}},
        spread_out{truth, {.step = kMeterStep}},
        picture(static_cast<std::size_t>(truth.stored_width) *
                static_cast<std::size_t>(truth.stored_height)) {
    for (std::size_t i = 0; i < world.gates.size(); ++i)
      if (world.gates[i].hidden_beyond > 0.0) hide(static_cast<int>(i), world.gates[i]);
  }

  /// The scene without a gate, for as long as it is far away. Its rectangles stay in the list, of
  /// no size: hits keep their numbers.
  void hide(int gate, const world::WorldGate& where) {
    std::vector<Rectangle> moved = standing;
    for (Rectangle& r : moved)
      if (r.gate == gate) r.edge_u.setZero(), r.edge_v.setZero();
    hidden_gate = where;
    without_gate = std::make_unique<TileCaster>(
        std::vector<const std::vector<Rectangle>*>{&scene.fixed, &moved});
  }
  /// Rectangles to be seen from there.
  [[nodiscard]] const TileCaster& seen_from(const Eigen::Vector3d& p_E) const {
    const bool hidden = without_gate && (hidden_gate.p_EG - p_E).norm() > hidden_gate.hidden_beyond;
    return hidden ? *without_gate : visible;
  }

  Shader lit(const world::LightConditions& light, const std::filesystem::path& cache_dir,
             int threads, const std::function<void()>& while_baking);
  [[nodiscard]] std::vector<Eye> eyes(const LensRays& lens, double t_start,
                                      std::span<const BodyPose> history) const;
  template <class Take>
  void cast(const LensRays& lens, double t_start, std::span<const BodyPose> history,
            Take&& take) const;
  void shoot(const LensRays& lens, double t_start, std::span<const BodyPose> history,
             std::vector<Float4>& radiance);

  world::CameraTruth camera;
  Scene scene;
  std::vector<Rectangle> standing;  ///< Part of scene.moved that does not walk.
  TileCaster visible;
  world::During lamps_out;
  world::WorldGate hidden_gate;
  std::unique_ptr<TileCaster> without_gate;
  float brightness = 1.0f;  ///< Brightness of all lamps.
  RayScene solid;
  double bake_seconds = 0.0;
  Shader shader;
  Sensor sensor;
  LensRays pixels;                   ///< Rays of a frame.
  LensRays centres;                  ///< One ray through each pixel: for masks.
  LensRays spread_out;               ///< A few of them meter a first frame.
  double exposed = camera.exposure;  ///< How long the last frame was [s].
  bool metered = false;
  std::vector<Float4> picture;
};

Shader CameraRenderer::Impl::lit(const world::LightConditions& light,
                                 const std::filesystem::path& cache_dir, int threads,
                                 const std::function<void()>& while_baking) {
  const RayScene fixed{{&scene.fixed}};
  const LightMap map = fixed_light(scene, fixed, cache_dir, threads, while_baking);
  bake_seconds = map.bake_seconds;
  return {scene, map, moved_light(scene, fixed, map, while_baking), light};
}

/// One for each line and sample. A single ray is cast in the middle of the exposure.
std::vector<Eye> CameraRenderer::Impl::eyes(const LensRays& lens, double t_start,
                                            std::span<const BodyPose> history) const {
  std::vector<Eye> result;
  for (int i = 0; i < lens.lines(); ++i) {
    const int line = i * lens.step(), samples = lens.samples();
    const double share =
        camera.stored_height > 1 ? static_cast<double>(line) / (camera.stored_height - 1) : 0.0;
    // Each line deals its quarters of the exposure to the samples anew: blur without a fixed
    // pattern.
    const auto key = static_cast<std::uint32_t>(line);
    const int turn = static_cast<int>(samples * hashed(key, 91));
    for (int sample = 0; sample < samples; ++sample) {
      const double part =
          samples == 1 ? 0.5 : hashed(key, 92u + static_cast<std::uint32_t>(sample));
      const double within = ((sample + turn) % samples + part) / samples;
      const double t = t_start + camera.readout * share + exposed * within;
      result.push_back(eye_of(interpolated(history, t), camera.p_BC));
    }
  }
  return result;
}

/// Casts all rays; `take(place, rays)` gets every tile.
template <class Take>
void CameraRenderer::Impl::cast(const LensRays& lens, double t_start,
                                std::span<const BodyPose> history, Take&& take) const {
  const TileCaster& caster = seen_from(interpolated(history, t_start).p_EB);
  const std::vector<Eye> from = eyes(lens, t_start, history);
  const std::vector<Rectangle> walking = scene.walkers_at(t_start);
  const TileCaster people{{&walking}, static_cast<int>(scene.fixed.size() + standing.size())};
  RayTile rays;
  for (int tile = 0; tile < lens.tiles(); ++tile) {
    lens.aim(tile, from, rays);
    TileCaster::clear(rays);
    caster.cast(rays);
    if (!walking.empty()) people.cast(rays);
    take(lens.place(tile), rays);
  }
}

/// The light of every pixel of the grid, line by line.
void CameraRenderer::Impl::shoot(const LensRays& lens, double t_start,
                                 std::span<const BodyPose> history, std::vector<Float4>& radiance) {
  radiance.resize(static_cast<std::size_t>(lens.width()) * static_cast<std::size_t>(lens.lines()));
  const int samples = lens.samples();
  cast(lens, t_start, history, [&](const LensRays::Place& at, const RayTile& rays) {
    for (int line = 0; line < at.lines; ++line) {
      Float4* to = radiance.data() + (at.line + line) * lens.width() + at.x;
      for (int x = 0; x < at.columns; ++x)
        to[x] = brightness * shader.radiance(rays, line * samples, x, samples);
    }
  });
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

CameraRenderer::CameraRenderer(const world::World& world, const world::CameraTruth& camera,
                               const world::LightConditions& light, std::uint64_t seed,
                               const std::filesystem::path& cache_dir, int bake_threads,
                               const std::function<void()>& while_baking)
    : impl_{std::make_unique<Impl>(world, camera, light, seed, cache_dir, bake_threads,
                                   while_baking)} {}

CameraRenderer::~CameraRenderer() = default;

void CameraRenderer::render(std::uint32_t frame, double t_start, std::span<const BodyPose> history,
                            std::vector<std::uint8_t>& uyvy) {
  impl_->solid.move(impl_->scene.walkers_at(t_start));
  impl_->brightness = world::within(impl_->lamps_out, t_start) ? kLampsOut : 1.0f;
  if (!impl_->metered) {
    impl_->exposed = impl_->sensor.exposure();
    impl_->shoot(impl_->spread_out, t_start, history, impl_->picture);
    impl_->sensor.meter(impl_->picture);
    impl_->metered = true;
  }
  impl_->exposed = impl_->sensor.exposure();
  impl_->shoot(impl_->pixels, t_start, history, impl_->picture);
  impl_->sensor.develop(frame, t_start, impl_->picture, uyvy);
  if (impl_->camera.jpeg_quality > 0)
    through_jpeg(uyvy, impl_->camera.stored_width, impl_->camera.stored_height,
                 impl_->camera.jpeg_quality);
}

void CameraRenderer::meter_anew() { impl_->metered = false; }

std::vector<std::uint8_t> CameraRenderer::gate_mask(double t_start,
                                                    std::span<const BodyPose> history) const {
  const world::CameraTruth& camera = impl_->camera;
  const int width = camera.width(), height = camera.height();
  const auto fixed = static_cast<int>(impl_->scene.fixed.size());
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(width * height));
  impl_->cast(
      impl_->centres, t_start, history, [&](const LensRays::Place& at, const RayTile& rays) {
        for (int line = 0; line < at.lines; ++line)
          for (int x = 0; x < at.columns; ++x) {
            const int number = rays.hit[line * RayTile::kLanes + x] - fixed;
            if (number < 0) continue;
            const Rectangle& hit = impl_->scene.moved[static_cast<std::size_t>(number)];
            if (!hit.bar) continue;
            const Eigen::Vector2d px = camera.upright(at.x + x, at.line + line);
            mask[static_cast<std::size_t>(std::lround(px.y()) * width + std::lround(px.x()))] =
                static_cast<std::uint8_t>(hit.gate < 0 ? 255 : std::min(hit.gate + 1, 254));
          }
      });
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

double CameraRenderer::exposure() const { return impl_->exposed; }

double CameraRenderer::bake_seconds() const { return impl_->bake_seconds; }

}  // namespace gatefly::sim
