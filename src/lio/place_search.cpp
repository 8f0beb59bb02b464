// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/place_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "allan_lio/lio/drift.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kEvery = 0.45;  ///< [s]
constexpr std::size_t kMostPoints = 150;
constexpr std::size_t kLeastPoints = 40;
constexpr double kReach = 10.0;        ///< [sigma]
constexpr double kFarthest = 2.0;      ///< [m]
constexpr double kLeastSigma = 1e-3;   ///< [m], so that nothing is certain
constexpr double kCoarse = 0.25;       ///< step [m]; a point fits within it
constexpr double kFine = 0.12;         ///< [m], within which a point fits in the end
constexpr double kFinestStep = 0.03;   ///< [m]
constexpr double kApart = 0.5;         ///< [m]; what is nearer is the same place
constexpr double kNatsPerPoint = 0.3;  ///< points on one surface err together, so one tells little
constexpr double kEvidence = 8.0;      ///< [nat] by which a place has to be better than the one at hand
constexpr double kDistinct = 4.0;      ///< [nat] by which it has to be better than any other
constexpr double kLeastShare = 0.3;    ///< of the points that have to fit at a place
constexpr double kIsBack = 0.6;        ///< of the points: the run is where it takes itself to be
constexpr std::size_t kFewer = 3;      ///< part of the points for coarse steps
constexpr int kMostPlaces = 5000;      ///< that are looked at; some 30 ms

/// Logarithm of the probability of an error of so many sigma, squared: Student's distribution.
double log_prior(double squared_sigmas) { return -2.0 * std::log1p(squared_sigmas / 3.0); }

/// Along the axes of the world and about its vertical through the IMU, the latter as the way [m] of a point at the
/// lever.
using Offset = Eigen::Vector4d;

struct Candidate {
  Offset at = Offset::Zero();
  double fit = 0.0;    ///< points that fit, each by how well it does
  double score = 0.0;  ///< [nat]
};

/// A scan that is tried at places around.
class Trial {
 public:
  /// `sigmas` of the position [m] and the heading [rad].
  Trial(const LioState& state, const VoxelMap& map, std::uint32_t last_epoch, const Eigen::Vector4d& sigmas)
      : pose_(state.nav.T_world_imu), map_(map), last_epoch_(last_epoch), sigmas_(sigmas) {}

  /// Takes the points that tell of the offset: not those on planes that any offset within reach leaves where they are.
  void choose_points(const std::vector<Eigen::Vector3f>& points) {
    const OldPlanes near{kCoarse, last_epoch_};
    const Eigen::Matrix3d rotation = pose_.rotation.toRotationMatrix();
    Eigen::Vector3d reach = (kReach * sigmas_.head<3>()).cwiseMin(kFarthest);
    if (reach.z() < kCoarse) reach.z() = 0.0;  // else a floor would tell that the run is back
    double squared = 0.0;
    Plane scratch;
    points_.reserve(points.size());
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Vector3d q = p.cast<double>(), arm = rotation * q;
      const Plane* plane = map_.find_old(arm + pose_.translation, pose_.translation, near);
      if (!plane) plane = map_.find(arm + pose_.translation, scratch);
      if (plane) {
        const double turn = Eigen::Vector3d::UnitZ().cross(arm).dot(plane->normal);
        if (plane->normal.cwiseAbs().dot(reach) + kReach * sigmas_[3] * std::abs(turn) < kFine) continue;
      }
      points_.push_back(q);
      squared += arm.head<2>().squaredNorm();
    }
    if (points_.empty()) return;
    lever_ = std::max(1.0, std::sqrt(squared / static_cast<double>(points_.size())));
    sigmas_[3] *= lever_;
    sigmas_ = sigmas_.cwiseMax(kLeastSigma);
    if (points_.size() > kMostPoints) points_ = spread_over(points_, kMostPoints);
    few_ = spread_over(points_, points_.size() / kFewer);
  }

  std::size_t points() const { return points_.size(); }

  PoseVector step(const Offset& at) const {
    PoseVector out;
    out << pose_.rotation.conjugate() * Eigen::Vector3d(0.0, 0.0, at[3] / lever_), at.head<3>();
    return out;
  }

  Candidate judge(const Offset& at) const { return judge(at, kFine, points_); }

  /// By a part of the points.
  Candidate judge_coarsely(const Offset& at) const { return judge(at, kCoarse, few_); }

  /// Of the coarse steps within reach, or within what of it can be looked through, the best that lies at least `apart`
  /// [m] from `from`.
  std::optional<Candidate> best_on_grid(const Offset& from, double apart) const {
    const std::array<int, 4> last = steps_within_reach();
    std::optional<Candidate> best;
    for (int x = -last[0]; x <= last[0]; ++x)
      for (int y = -last[1]; y <= last[1]; ++y)
        for (int z = -last[2]; z <= last[2]; ++z)
          for (int turn = -last[3]; turn <= last[3]; ++turn) {
            const Offset at = kCoarse * Offset(x, y, z, turn);
            if ((at - from).norm() < apart) continue;
            const Candidate candidate = judge_coarsely(at);
            if (!best || candidate.score > best->score) best = candidate;
          }
    return best;
  }

  /// The best of those half a coarse step around, from where it climbs by ever smaller steps along each axis.
  Candidate refine(const Offset& from) const {
    Candidate best = judge(from);
    for (const int x : {-1, 0, 1})
      for (const int y : {-1, 0, 1})
        for (const int turn : {-1, 0, 1}) {
          const Candidate candidate = judge(from + 0.5 * kCoarse * Offset(x, y, 0.0, turn));
          if (candidate.score > best.score) best = candidate;
        }
    for (double step = 0.25 * kCoarse; step >= kFinestStep; step *= 0.5)
      for (bool better = true; better;) {
        better = false;
        for (int k = 0; k < 4; ++k)
          for (const double sign : {-1.0, 1.0}) {
            const Candidate candidate = judge(best.at + sign * step * Offset::Unit(k));
            if (!(candidate.score > best.score)) continue;
            best = candidate;
            better = true;
          }
      }
    return best;
  }

 private:
  /// `fit` as if all points had been tried.
  Candidate judge(const Offset& at, double tolerance, const std::vector<Eigen::Vector3d>& points) const {
    const Eigen::Matrix3d rotation = (pose_.rotation * exp_so3(step(at).head<3>())).toRotationMatrix();
    const Eigen::Vector3d translation = pose_.translation + at.head<3>();
    const OldPlanes near{tolerance, last_epoch_};
    Candidate out;
    out.at = at;
    for (const Eigen::Vector3d& q : points) {
      const Eigen::Vector3d point = rotation * q + translation;
      const Plane* plane = map_.find_old(point, translation, near);
      if (!plane) continue;
      const double off = plane->distance(point) / tolerance;
      out.fit += 1.0 - off * off;
    }
    out.fit *= static_cast<double>(points_.size()) / static_cast<double>(points.size());
    out.score = kNatsPerPoint * out.fit + log_prior(at.cwiseQuotient(sigmas_).squaredNorm());
    return out;
  }

  /// Not in any rhythm that the beams' order has.
  static std::vector<Eigen::Vector3d> spread_over(const std::vector<Eigen::Vector3d>& points, std::size_t count) {
    constexpr double kGoldenRatio = 0.6180339887498949;
    std::vector<Eigen::Vector3d> out;
    out.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double turns = kGoldenRatio * static_cast<double>(i);
      out.push_back(points[static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(points.size()))]);
    }
    return out;
  }

  std::array<int, 4> steps_within_reach() const {
    std::array<int, 4> last{};
    for (int k = 0; k < 4; ++k) last[k] = static_cast<int>(std::min(kReach * sigmas_[k], kFarthest) / kCoarse);
    const auto places = [&last] {
      int product = 1;
      for (const int n : last) product *= 2 * n + 1;
      return product;
    };
    while (places() > kMostPlaces) --*std::max_element(last.begin(), last.end());
    return last;
  }

  RigidTransform pose_;
  const VoxelMap& map_;
  std::uint32_t last_epoch_;
  Offset sigmas_;
  double lever_ = 1.0;  ///< root mean square of the points' horizontal distances [m]
  std::vector<Eigen::Vector3d> points_, few_;
};

Eigen::Vector4d sigmas_of(const PoseMatrix& covariance, const LioState& state) {
  const Eigen::Vector3d up = state.nav.T_world_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Vector4d out;
  out << covariance.diagonal().tail<3>(), up.dot(covariance.topLeftCorner<3, 3>() * up);
  return out.cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

bool PlaceSearch::follow_drift(const LioState& state, const AbsoluteCovariance& absolute, bool estimate_extrinsics) {
  const std::vector<PoseMatrix> against_parts = absolute.relative_to_parts(state, estimate_extrinsics);
  const OldPlanes old = old_planes(against_parts, absolute.last_epochs());
  if (old.reach == 0.0) return true;
  const Eigen::Vector4d sigmas = sigmas_of(*farthest_part(against_parts), state);
  if (!sigmas.allFinite() || sigmas.head<3>().maxCoeff() > kFarthest) return false;
  if (!drift_) drift_ = Drift{sigmas};
  drift_->sigmas = drift_->sigmas.cwiseMax(sigmas);
  if (!drift_->found_place) drift_->last_epoch = old.last_epoch;
  return true;
}

std::optional<Place> PlaceSearch::look(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                                       const VoxelMap& map, const AbsoluteCovariance& absolute,
                                       bool estimate_extrinsics) {
  if (looked_at_ && seconds_between(*looked_at_, state.nav.stamp) < kEvery) return std::nullopt;
  looked_at_ = state.nav.stamp;
  if (!follow_drift(state, absolute, estimate_extrinsics) || !drift_) return std::nullopt;

  Trial trial(state, map, drift_->last_epoch, drift_->sigmas);
  trial.choose_points(points_imu);
  if (trial.points() < kLeastPoints) return std::nullopt;
  const double points = static_cast<double>(trial.points());
  const Candidate here = trial.judge(Offset::Zero());
  if (here.fit > kIsBack * points) return std::nullopt;
  const std::optional<Candidate> coarse = trial.best_on_grid(Offset::Zero(), 0.0);
  if (coarse->fit < kLeastShare * points) return std::nullopt;
  const Candidate best = trial.refine(coarse->at);
  if (best.fit < kLeastShare * points || best.score < here.score + kEvidence || best.at.norm() < kFine)
    return std::nullopt;
  if (const std::optional<Candidate> other = trial.best_on_grid(best.at, kApart)) {
    const Candidate refined = trial.refine(other->at);
    if ((refined.at - best.at).norm() > kCoarse && refined.score > best.score - kDistinct) return std::nullopt;
  }
  drift_->found_place = true;
  return Place{trial.step(best.at), drift_->last_epoch};
}

}  // namespace allan_lio
