// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "allan_lio/map/epoch_sieve.h"
#include "allan_lio/map/voxel_map.h"
#include "allan_lio/map/voxel_store.h"
#include "old_plane.h"
#include "plane_voxel.h"

namespace allan_lio {
namespace {

/// A plane also takes the points this far outside of its voxel (part of the edge) if their foot lies inside, so that a
/// wall that runs along a border is seen whole instead of being cut into two halves of its noise. A point is compared
/// with the plane in whose voxel its foot lies, so what makes a plane and what is compared with it are the same patch
/// of the surface: were one of them larger, the curve of a surface would show as an offset, the same everywhere.
constexpr double kOverlap = 0.1;
constexpr double kSameSurface = 0.75;       ///< squared cosine between the normals of neighbouring planes: 30 deg
constexpr std::uint32_t kFullAfter = 1000;  ///< points; then the plane is fixed and anchors later visits
constexpr double kGate = 3.5;               ///< [sigma]; a point farther from the plane is of another surface
constexpr double kMaxLean = 0.15;           ///< [rad]
constexpr double kMaxStructure = 0.06;      ///< of the edge
constexpr double kLeastAspect = 3.0;
constexpr std::uint32_t kMinPoints = 8;
constexpr std::uint32_t kMaxIndependent = 100;
constexpr std::size_t kRenewedIn = 64;  ///< insertions

class PlaneVoxelMap : public VoxelMap {
 public:
  explicit PlaneVoxelMap(const VoxelMapOptions& options)
      : options_(options),
        limits_{options.range_noise * options.range_noise,
                kMaxStructure * options.voxel_size,
                kMaxLean,
                kLeastAspect,
                kMinPoints,
                kMaxIndependent},
        store_(options.voxel_size, options.max_mb - 1e-6 * static_cast<double>(EpochSieve::bytes())) {}

  void insert(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& sensor, std::uint32_t epoch) override {
    epoch_ = epoch;
    sensor_ = sensor;
    for (const Eigen::Vector3d& p : points) {
      if (store_.is_full()) make_room(sensor);
      insert_point(p);
    }
    refit_touched();
    renew_sieve();
  }

  const Plane* find(const Eigen::Vector3d& point, Plane&) const override {
    const VoxelCoordinates home = voxel_of(point, store_.inverse_edge());
    const Plane* plane = plane_in(home, point);
    if (!plane) return nullptr;
    const VoxelCoordinates under = voxel_of(plane->foot(point), store_.inverse_edge());
    if (in_same_cube(under, home)) return plane;
    const Plane* beside = plane_in(under, point);
    if (!beside || !belongs(point, *beside)) return plane;
    const double cosine = beside->normal.dot(plane->normal);
    return cosine * cosine >= kSameSurface ? beside : plane;
  }

  const Plane* find_old(const Eigen::Vector3d& point, const Eigen::Vector3d& sensor,
                        const OldPlanes& old_planes) const override {
    const VoxelCoordinates home = voxel_of(point, store_.inverse_edge());
    if (!sieve_.may_be_near(home, old_planes.last_epoch)) return nullptr;
    return find_old_plane(store_, point, sensor, old_planes);
  }

  bool gather_old(const Eigen::AlignedBox3d& box, std::uint32_t last_epoch, OldPlaneBox& out) const override {
    return gather_old_planes(store_, sieve_, box, last_epoch, out);
  }

  void clear() override {
    store_.clear();
    sieve_.clear();
    renewed_ = 0;
  }
  std::size_t voxels() const override { return store_.size(); }
  std::size_t bytes() const override {
    return store_.bytes() + touched_.capacity() * sizeof(std::uint32_t) + EpochSieve::bytes();
  }

  std::vector<Eigen::Vector3d> points() const override {
    std::vector<Eigen::Vector3d> out;
    for (std::size_t i = 0; i < store_.size(); ++i)
      if (store_[i].is_plane) out.push_back(store_[i].plane.center);
    return out;
  }

 private:
  /// The plane in the voxel that `point` belongs to, or null.
  const Plane* plane_in(VoxelCoordinates c, const Eigen::Vector3d& point) const {
    const PlaneVoxel* first = store_.find(c);
    if (!first || !first->is_plane) return nullptr;
    if (!first->is_divided) return &first->plane;
    c.second = true;
    const PlaneVoxel* second = store_.find(c);
    if (!second || !second->is_plane) return &first->plane;
    // In the corner between the two nobody can tell whose point it is, and the guess errs to the same side every time.
    const bool of_first = belongs(point, first->plane), of_second = belongs(point, second->plane);
    if (of_first && of_second) return nullptr;
    if (of_first != of_second) return of_first ? &first->plane : &second->plane;
    const bool is_nearer = std::abs(second->plane.distance(point)) < std::abs(first->plane.distance(point));
    return is_nearer ? &second->plane : &first->plane;
  }

  void make_room(const Eigen::Vector3d& sensor) {
    refit_touched();
    const std::vector<std::uint32_t> kept = store_.make_room(sensor, options_.radius);
    for (std::size_t i = 0; i < store_.size(); ++i) store_[i].plane.group = static_cast<std::uint32_t>(i);
    renewed_ = static_cast<std::size_t>(std::lower_bound(kept.begin(), kept.end(), renewed_) - kept.begin());
  }

  /// Some of the voxels, the next ones in turn, so that every insertion costs the same.
  void renew_sieve() {
    const std::size_t end = std::min(renewed_ + store_.size() / kRenewedIn + 1, store_.size());
    for (; renewed_ < end; ++renewed_) {
      const PlaneVoxel& voxel = store_[renewed_];
      if (voxel.is_plane) sieve_.renew(voxel.coordinates, voxel.plane.epoch);
    }
    if (renewed_ < store_.size()) return;
    sieve_.finish_renewal();
    renewed_ = 0;
  }

  void refit_touched() {
    for (const std::uint32_t i : touched_) refit(i);
    touched_.clear();
  }

  void insert_point(const Eigen::Vector3d& p) {
    const Eigen::Vector3d scaled = p * store_.inverse_edge();
    const VoxelCoordinates home = voxel_of(p, store_.inverse_edge());
    int low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<int>(std::floor(scaled[k] - kOverlap));
      high[k] = static_cast<int>(std::floor(scaled[k] + kOverlap));
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z) {
          const VoxelCoordinates c{x, y, z};
          add_to_voxel(c, in_same_cube(c, home), p);
        }
  }

  /// A voxel that is no plane yet takes only the points inside of it (`is_home`): which of those beside it have their
  /// foot in it is not known.
  void add_to_voxel(const VoxelCoordinates& c, bool is_home, const Eigen::Vector3d& p) {
    const std::uint32_t i = is_home ? store_.find_or_make(c) : store_.number_of(c);
    if (i == VoxelIndex::kNone) return;
    PlaneVoxel& voxel = store_[i];
    if (!voxel.is_plane && !is_home) return;
    if (voxel.is_plane && !belongs(p, voxel.plane)) {
      if (c.second) return;  // a third surface is left out
      voxel.is_divided |= is_home;
      add_to_voxel({c.x, c.y, c.z, true}, is_home, p);
      return;
    }
    if (voxel.is_plane && !in_same_cube(voxel_of(voxel.plane.foot(p), store_.inverse_edge()), c)) return;
    if (voxel.sums.count >= kFullAfter) return;
    voxel.sums.add(p - store_.voxel_center(c), (p - sensor_).normalized());
    voxel.epochs += epoch_;
    if (voxel.is_touched) return;
    voxel.is_touched = true;
    touched_.push_back(i);
  }

  /// Again only when the count has grown by a tenth: a plane is fitted some 50 times in its life.
  void refit(std::uint32_t i) {
    PlaneVoxel& voxel = store_[i];
    voxel.is_touched = false;
    if (10 * voxel.sums.count < 11 * voxel.fitted_at) return;
    voxel.fitted_at = voxel.sums.count;
    const bool was_plane = voxel.is_plane;
    voxel.is_plane = fit_plane(voxel.sums, store_.voxel_center(voxel.coordinates), limits_, voxel.plane);
    if (voxel.plane.view.dot(voxel.plane.center - sensor_) < 0.0) voxel.plane.view = -voxel.plane.view;
    voxel.plane.group = i;
    voxel.plane.epoch = static_cast<std::uint32_t>(voxel.epochs / voxel.sums.count);
    if (voxel.is_plane && !was_plane) sieve_.note(voxel.coordinates, voxel.plane.epoch);
  }

  bool belongs(const Eigen::Vector3d& point, const Plane& plane) const {
    const double distance = plane.distance(point);
    const double variance = std::max(plane.thickness, limits_.point_variance) + plane.variance_at(point);
    return distance * distance < kGate * kGate * variance;
  }

  VoxelMapOptions options_;
  PlaneLimits limits_;
  VoxelStore<PlaneVoxel> store_;
  EpochSieve sieve_;
  std::size_t renewed_ = 0;  ///< so many voxels, the first ones, the sieve knows anew
  std::vector<std::uint32_t> touched_;
  std::uint32_t epoch_ = 0;                           ///< of the points that are being inserted
  Eigen::Vector3d sensor_ = Eigen::Vector3d::Zero();  ///< where they were seen from [m]
};

}  // namespace

std::unique_ptr<VoxelMap> make_plane_voxel_map(const VoxelMapOptions& options) {
  return std::make_unique<PlaneVoxelMap>(options);
}

}  // namespace allan_lio
