// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "allan_lio/map/voxel_map.h"
#include "allan_lio/map/voxel_store.h"

namespace allan_lio {
namespace {

constexpr int kCapacity = 20;     ///< points a voxel
constexpr double kSpacing = 0.2;  ///< least distance between points of a voxel, of the edge
constexpr int kNearest = 5;
constexpr double kMaxStructure = 0.1;  ///< [m], 1 sigma of the nearest points about their plane
constexpr double kMaxLean = 0.5;       ///< [rad]
constexpr double kLeastAspect = 1.0;

struct PointVoxel {
  VoxelCoordinates coordinates{};
  int count = 0;
  std::uint32_t epoch = 0;            ///< of its first point
  Eigen::Vector3f points[kCapacity];  ///< about the voxel's center [m]
};

/// The nearest points seen so far, nearest first.
struct Nearest {
  double distance[kNearest];
  Eigen::Vector3d offset[kNearest];  ///< from the query [m]
  std::uint32_t epoch = 0;           ///< of the nearest point's voxel
  int count = 0;

  void offer(double squared, const Eigen::Vector3d& point, std::uint32_t point_epoch) {
    if (count == kNearest && squared >= distance[kNearest - 1]) return;
    int i = count < kNearest ? count++ : kNearest - 1;
    for (; i > 0 && distance[i - 1] > squared; --i) {
      distance[i] = distance[i - 1];
      offset[i] = offset[i - 1];
    }
    distance[i] = squared;
    offset[i] = point;
    if (i == 0) epoch = point_epoch;
  }
};

class PointVoxelMap : public VoxelMap {
 public:
  explicit PointVoxelMap(const VoxelMapOptions& options)
      : options_(options),
        limits_{options.range_noise * options.range_noise, kMaxStructure, kMaxLean, kLeastAspect, kNearest, kNearest},
        store_(options.voxel_size, options.max_mb) {}

  void insert(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& sensor, std::uint32_t epoch) override {
    const double least = kSpacing * options_.voxel_size;
    for (const Eigen::Vector3d& p : points) {
      if (store_.is_full()) store_.make_room(sensor, options_.radius);
      const VoxelCoordinates c = voxel_of(p, store_.inverse_edge());
      const std::uint32_t i = store_.find_or_make(c);
      PointVoxel& voxel = store_[i];
      if (voxel.count == kCapacity) continue;
      const Eigen::Vector3f local = (p - store_.voxel_center(c)).cast<float>();
      const bool crowded = std::any_of(voxel.points, voxel.points + voxel.count, [&](const Eigen::Vector3f& q) {
        return (q - local).squaredNorm() < least * least;
      });
      if (crowded) continue;
      if (voxel.count == 0) voxel.epoch = epoch;
      voxel.points[voxel.count++] = local;
    }
  }

  const Plane* find(const Eigen::Vector3d& point, Plane& scratch) const override {
    const VoxelCoordinates c = voxel_of(point, store_.inverse_edge());
    Nearest nearest;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (const PointVoxel* voxel = store_.find({c.x + x, c.y + y, c.z + z})) offer_all(*voxel, point, nearest);
    if (nearest.count < kNearest) return nullptr;
    PlaneSums sums;
    for (const Eigen::Vector3d& offset : nearest.offset) sums.add(offset);
    if (!fit_plane(sums, point, limits_, scratch)) return nullptr;
    scratch.thickness = std::max(scratch.thickness, limits_.point_variance);  // five points tell too little of it
    scratch.group = Plane::kNoGroup;
    scratch.epoch = nearest.epoch;
    return &scratch;
  }

  void clear() override { store_.clear(); }
  std::size_t voxels() const override { return store_.size(); }
  std::size_t bytes() const override { return store_.bytes(); }

  std::vector<Eigen::Vector3d> points() const override {
    std::vector<Eigen::Vector3d> out;
    for (std::size_t i = 0; i < store_.size(); ++i)
      for (int k = 0; k < store_[i].count; ++k)
        out.push_back(store_.voxel_center(store_[i].coordinates) + store_[i].points[k].cast<double>());
    return out;
  }

 private:
  void offer_all(const PointVoxel& voxel, const Eigen::Vector3d& query, Nearest& nearest) const {
    const Eigen::Vector3d base = store_.voxel_center(voxel.coordinates) - query;
    for (int k = 0; k < voxel.count; ++k) {
      const Eigen::Vector3d offset = base + voxel.points[k].cast<double>();
      nearest.offer(offset.squaredNorm(), offset, voxel.epoch);
    }
  }

  VoxelMapOptions options_;
  PlaneLimits limits_;
  VoxelStore<PointVoxel> store_;
};

}  // namespace

std::unique_ptr<VoxelMap> make_point_voxel_map(const VoxelMapOptions& options) {
  return std::make_unique<PointVoxelMap>(options);
}

}  // namespace allan_lio
