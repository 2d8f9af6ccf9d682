// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/ray_scene.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <string>

namespace gatefly::sim {
namespace {

// Embree 4 takes what Embree 3 called a context as arguments of each call.
#if RTC_VERSION_MAJOR >= 4
struct Query : RTCIntersectArguments {
  explicit Query(RayScene::Rays kind) : RTCIntersectArguments{} {
    rtcInitIntersectArguments(this);
    flags = kind == RayScene::Rays::kCoherent ? RTC_RAY_QUERY_FLAG_COHERENT
                                              : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
};
struct ShadowQuery : RTCOccludedArguments {
  ShadowQuery() : RTCOccludedArguments{} {
    rtcInitOccludedArguments(this);
    flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
};
#else
RTCIntersectContext context_of(RayScene::Rays kind) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = kind == RayScene::Rays::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}
#endif

void cast(RTCScene scene, const RayScene::Valid& valid, RTCRayHit16& rays, RayScene::Rays kind) {
#if RTC_VERSION_MAJOR >= 4
  Query query{kind};
  rtcIntersect16(valid.lane, scene, &rays, &query);
#else
  RTCIntersectContext context = context_of(kind);
  rtcIntersect16(valid.lane, scene, &context, &rays);
#endif
}

void cast(RTCScene scene, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
  Query query{RayScene::Rays::kIncoherent};
  rtcIntersect1(scene, &ray, &query);
#else
  RTCIntersectContext context = context_of(RayScene::Rays::kIncoherent);
  rtcIntersect1(scene, &context, &ray);
#endif
}

void shadow(RTCScene scene, const RayScene::Valid& valid, RTCRay16& rays) {
#if RTC_VERSION_MAJOR >= 4
  ShadowQuery query;
  rtcOccluded16(valid.lane, scene, &rays, &query);
#else
  RTCIntersectContext context = context_of(RayScene::Rays::kIncoherent);
  rtcOccluded16(valid.lane, scene, &context, &rays);
#endif
}

void shadow(RTCScene scene, RTCRay& ray) {
#if RTC_VERSION_MAJOR >= 4
  ShadowQuery query;
  rtcOccluded1(scene, &ray, &query);
#else
  RTCIntersectContext context = context_of(RayScene::Rays::kIncoherent);
  rtcOccluded1(scene, &context, &ray);
#endif
}

/// Four corners each.
void write(std::span<const Rectangle> rectangles, float* vertex) {
  for (const Rectangle& r : rectangles) {
    const Eigen::Vector3f corners[4] = {r.corner, r.corner + r.edge_u,
                                        r.corner + r.edge_u + r.edge_v, r.corner + r.edge_v};
    for (const Eigen::Vector3f& corner : corners) {
      std::memcpy(vertex, corner.data(), 3 * sizeof(float));
      vertex += 3;
    }
  }
}

/// A geometry of these rectangles in a scene; the caller's to release.
RTCGeometry attach(RTCDevice device, RTCScene scene, std::span<const Rectangle> rectangles,
                   unsigned id) {
  const std::size_t count = rectangles.size();
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * count));
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), count));
  if (count > 0 && (vertex == nullptr || index == nullptr)) {
    rtcReleaseGeometry(geometry);
    throw std::runtime_error("camera: no memory for the scene (Embree)");
  }
  write(rectangles, vertex);
  for (unsigned i = 0; i < 4 * count; ++i) index[i] = i;
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  return geometry;
}

std::runtime_error failed(RTCError why) {
  switch (why) {
    case RTC_ERROR_OUT_OF_MEMORY:
      return std::runtime_error("camera: no memory for the scene (Embree)");
    case RTC_ERROR_UNSUPPORTED_CPU:
      return std::runtime_error("camera: Embree needs AVX2, which this processor has not");
    default:
      return std::runtime_error("camera: Embree fails, error " +
                                std::to_string(static_cast<int>(why)));
  }
}

/// Embree says no by itself: what is committed without memory is just empty.
void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) throw failed(error);
}

constexpr unsigned kMoving = 1;  // geometry number of what moves

}  // namespace

void RayScene::intersect(const Valid& valid, RTCRayHit16& rays, Rays kind) const {
  std::fill(std::begin(rays.ray.mask), std::end(rays.ray.mask), ~0u);
  cast(scene_, valid, rays, kind);
  if (moving_ == nullptr) return;
  cast(moving_, valid, rays, kind);
  for (int i = 0; i < 16; ++i)
    if (rays.hit.geomID[i] == kMoving) rays.hit.primID[i] += still_;
}

void RayScene::intersect(RTCRayHit& ray) const {
  ray.ray.mask = ~0u;
  cast(scene_, ray);
  if (moving_ == nullptr) return;
  cast(moving_, ray);
  if (ray.hit.geomID == kMoving) ray.hit.primID += still_;
}

void RayScene::occluded(const Valid& valid, RTCRay16& rays) const {
  std::fill(std::begin(rays.mask), std::end(rays.mask), ~0u);
  shadow(scene_, valid, rays);
  if (moving_ != nullptr) shadow(moving_, valid, rays);
}

void RayScene::occluded(RTCRay& ray) const {
  ray.mask = ~0u;
  shadow(scene_, ray);
  if (moving_ != nullptr && ray.tfar >= 0.0f) shadow(moving_, ray);
}

RayScene::RayScene(const std::vector<const std::vector<Rectangle>*>& lists, std::size_t moving) {
  // One instruction set and one thread: the same tree, the same hits, wherever AVX2 exists.
  device_ = rtcNewDevice("isa=avx2,threads=1");
  if (device_ == nullptr) throw failed(rtcGetDeviceError(nullptr));
  try {
    build(lists, moving);
  } catch (...) {
    release();
    throw;
  }
}

void RayScene::build(const std::vector<const std::vector<Rectangle>*>& lists, std::size_t moving) {
  std::vector<Rectangle> all;
  for (const auto* list : lists) all.insert(all.end(), list->begin(), list->end());
  still_ = static_cast<unsigned>(all.size() - moving);
  scene_ = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  rtcReleaseGeometry(attach(device_, scene_, {all.data(), still_}, 0));
  rtcCommitScene(scene_);
  check(device_);
  if (moving == 0) return;
  moving_ = rtcNewScene(device_);
  moving_quads_ = attach(device_, moving_, {all.data() + still_, moving}, kMoving);
  rtcCommitScene(moving_);
  check(device_);
}

void RayScene::move(std::span<const Rectangle> rectangles) {
  if (moving_ == nullptr) return;
  write(rectangles,
        static_cast<float*>(rtcGetGeometryBufferData(moving_quads_, RTC_BUFFER_TYPE_VERTEX, 0)));
  rtcUpdateGeometryBuffer(moving_quads_, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(moving_quads_);
  rtcCommitScene(moving_);
}

RayScene::~RayScene() { release(); }

void RayScene::release() {
  if (moving_quads_ != nullptr) rtcReleaseGeometry(moving_quads_);
  if (moving_ != nullptr) rtcReleaseScene(moving_);
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

}  // namespace gatefly::sim
