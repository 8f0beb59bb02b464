// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/ray_caster.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace allan_lio {
namespace {

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

/// normal . p = offset
struct Plane {
  Eigen::Vector3d normal;
  double offset;
};

Plane plane_of(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
  const Eigen::Vector3d normal = (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).normalized();
  return {normal, normal.dot(a)};
}

void attach(RTCDevice device, RTCScene scene, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (vertices != nullptr && indices != nullptr) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) vertices[3 * i + axis] = static_cast<float>(mesh.vertices[i][axis]);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      std::copy(mesh.triangles[i].begin(), mesh.triangles[i].end(), indices + 3 * i);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
}

}  // namespace

struct RayCaster::Impl {
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter> device;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter> scene;
  std::vector<Plane> planes;
};

RayCaster::RayCaster(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->device.reset(rtcNewDevice(nullptr));
  if (!impl_->device) throw std::runtime_error("the ray-tracing library Embree cannot be started");
  impl_->scene.reset(rtcNewScene(impl_->device.get()));
  rtcSetSceneFlags(impl_->scene.get(), RTC_SCENE_FLAG_ROBUST);  // no rays through the seams between triangles
  attach(impl_->device.get(), impl_->scene.get(), mesh);
  const RTCError error = rtcGetDeviceError(impl_->device.get());
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error("the ray-tracing library Embree refuses the scene, error " + std::to_string(error));
  for (const auto& triangle : mesh.triangles) impl_->planes.push_back(plane_of(mesh, triangle));
}

RayCaster::~RayCaster() = default;

std::optional<RayHit> RayCaster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                      double max_range) const {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tfar = static_cast<float>(max_range) * 1.0001f;  // the limit itself is kept in double, below
  ray.ray.mask = 0xffffffffu;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene.get(), &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Plane& plane = impl_->planes[ray.hit.primID];
  const double approach = plane.normal.dot(direction);
  // A ray that grazes the plane has no well-defined meeting point; single precision's is as good as any.
  const double range = std::abs(approach) > 1e-4 ? (plane.offset - plane.normal.dot(origin)) / approach
                                                 : static_cast<double>(ray.ray.tfar);
  if (range > max_range) return std::nullopt;
  return RayHit{range, approach > 0 ? Eigen::Vector3d(-plane.normal) : plane.normal};
}

}  // namespace allan_lio
