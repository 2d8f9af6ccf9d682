// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/ray_scene.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

namespace gatefly::sim {
namespace {

RTCIntersectContext context(RTCIntersectContextFlags flags) {
  RTCIntersectContext result;
  rtcInitIntersectContext(&result);
  result.flags = flags;
  return result;
}

}  // namespace

RTCIntersectContext RayScene::coherent() { return context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT); }
RTCIntersectContext RayScene::incoherent() {
  return context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
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
