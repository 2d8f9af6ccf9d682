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

}  // namespace

void RayScene::intersect(const Valid& valid, RTCRayHit16& rays, Rays kind) const {
  std::fill(std::begin(rays.ray.mask), std::end(rays.ray.mask), ~0u);
#if RTC_VERSION_MAJOR >= 4
  Query query{kind};
  rtcIntersect16(valid.lane, scene_, &rays, &query);
#else
  RTCIntersectContext context = context_of(kind);
  rtcIntersect16(valid.lane, scene_, &context, &rays);
#endif
}

void RayScene::intersect(RTCRayHit& ray) const {
  ray.ray.mask = ~0u;
#if RTC_VERSION_MAJOR >= 4
  Query query{Rays::kIncoherent};
  rtcIntersect1(scene_, &ray, &query);
#else
  RTCIntersectContext context = context_of(Rays::kIncoherent);
  rtcIntersect1(scene_, &context, &ray);
#endif
}

void RayScene::occluded(const Valid& valid, RTCRay16& rays) const {
  std::fill(std::begin(rays.mask), std::end(rays.mask), ~0u);
#if RTC_VERSION_MAJOR >= 4
  ShadowQuery query;
  rtcOccluded16(valid.lane, scene_, &rays, &query);
#else
  RTCIntersectContext context = context_of(Rays::kIncoherent);
  rtcOccluded16(valid.lane, scene_, &context, &rays);
#endif
}

void RayScene::occluded(RTCRay& ray) const {
  ray.mask = ~0u;
#if RTC_VERSION_MAJOR >= 4
  ShadowQuery query;
  rtcOccluded1(scene_, &ray, &query);
#else
  RTCIntersectContext context = context_of(Rays::kIncoherent);
  rtcOccluded1(scene_, &context, &ray);
#endif
}

RayScene::RayScene(const std::vector<const std::vector<Rectangle>*>& lists) {
  // One instruction set and one thread: the same tree, the same hits, wherever AVX2 exists.
  device_ = rtcNewDevice("isa=avx2,threads=1");
  if (device_ == nullptr)
    throw std::runtime_error("camera: Embree does not start (needs AVX2), error " +
                             std::to_string(static_cast<int>(rtcGetDeviceError(nullptr))));
  std::size_t count = 0;
  for (const auto* list : lists) count += list->size();
  scene_ = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * count));
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), count));
  if (count > 0 && (vertex == nullptr || index == nullptr))
    throw std::runtime_error("camera: Embree has no memory for the scene");
  unsigned next = 0;
  for (const auto* list : lists) {
    for (const Rectangle& r : *list) {
      const Eigen::Vector3f corners[4] = {r.corner, r.corner + r.edge_u,
                                          r.corner + r.edge_u + r.edge_v, r.corner + r.edge_v};
      for (const Eigen::Vector3f& corner : corners) {
        std::memcpy(vertex + 3 * next, corner.data(), 3 * sizeof(float));
        index[next] = next;
        ++next;
      }
    }
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

RayScene::~RayScene() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

}  // namespace gatefly::sim
