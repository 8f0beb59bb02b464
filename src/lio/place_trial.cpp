// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_trial.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "allan_lio/lio/drift.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr std::size_t kMostPoints = 150;
constexpr double kReach = 10.0;        ///< [sigma]
constexpr double kLeastSigma = 1e-3;   ///< [m], so that nothing is certain
constexpr double kFinestStep = 0.03;   ///< [m]
constexpr double kNatsPerPoint = 0.3;  ///< points on one surface err together, so one tells little
constexpr std::size_t kFewer = 3;      ///< part of the points for coarse steps
constexpr int kMostPlaces = 5000;      ///< that are looked at; some 15 ms, 66 where boxes are too large

/// Logarithm of the probability of an error of so many sigma, squared: Student's distribution.
double log_prior(double squared_sigmas) { return -2.0 * std::log1p(squared_sigmas / 3.0); }

/// How well a point fits a plane: 1 on it, 0 where it is `tolerance` off [m].
double fit_of(const Plane& plane, const Eigen::Vector3d& point, double tolerance) {
  const double off = plane.distance(point) / tolerance;
  return 1.0 - off * off;
}

/// A step by which all of so many points are visited once, the first of them spread over all, and in no rhythm that
/// the beams' order has.
std::size_t visiting_step(std::size_t count) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  auto step = static_cast<std::size_t>(std::round(kGoldenRatio * static_cast<double>(count)));
  while (std::gcd(step, count) > 1) ++step;
  return step;
}

}  // namespace

PlaceTrial::PlaceTrial(const std::vector<Eigen::Vector3f>& points, const LioState& state, const VoxelMap& map,
                       std::uint32_t last_epoch, const Eigen::Vector4d& sigmas)
    : pose_(state.nav.T_world_imu),
      map_(map),
      last_epoch_(last_epoch),
      position_sigmas_(sigmas.head<3>()),
      heading_sigma_(sigmas[3]) {
  choose_points(points);
}

void PlaceTrial::choose_points(const std::vector<Eigen::Vector3f>& points) {
  const OldPlanes near{kCoarse, last_epoch_};
  const Eigen::Matrix3d rotation = pose_.rotation.toRotationMatrix();
  Eigen::Vector3d reach = (kReach * position_sigmas_).cwiseMin(kFarthest);
  if (reach.z() < kCoarse) reach.z() = 0.0;  // else a floor would tell that the run is back
  double squared = 0.0;
  Plane scratch;
  points_.reserve(kMostPoints);
  const std::size_t step = visiting_step(points.size());
  for (std::size_t i = 0, at = 0; i < points.size() && points_.size() < kMostPoints; ++i) {
    const Eigen::Vector3d q = points[at].cast<double>(), arm = rotation * q;
    at = (at + step) % points.size();
    const auto stays = [&](const Plane* plane) {
      if (!plane) return false;
      const double turn = Eigen::Vector3d::UnitZ().cross(arm).dot(plane->normal);
      return plane->normal.cwiseAbs().dot(reach) + kReach * heading_sigma_ * std::abs(turn) < kFine;
    };
    if (stays(map_.find(arm + pose_.translation, scratch))) continue;  // the floor, at little cost
    if (stays(map_.find_old(arm + pose_.translation, pose_.translation, near))) continue;
    points_.push_back(q);
    squared += arm.head<2>().squaredNorm();
  }
  if (points_.empty()) return;
  lever_ = std::max(1.0, std::sqrt(squared / static_cast<double>(points_.size())));
  sigmas_ << position_sigmas_, heading_sigma_ * lever_;
  sigmas_ = sigmas_.cwiseMax(kLeastSigma);
  few_.assign(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(points_.size() / kFewer));
}

PoseVector PlaceTrial::step(const PlaceOffset& at) const {
  PoseVector out;
  out << pose_.rotation.conjugate() * Eigen::Vector3d(0.0, 0.0, at[3] / lever_), at.head<3>();
  return out;
}

std::optional<PlaceCandidate> PlaceTrial::best_on_grid(const PlaceOffset& from, double apart) {
  if (grid_.empty()) try_grid();
  std::optional<PlaceCandidate> best;
  for (const PlaceCandidate& candidate : grid_)
    if ((candidate.at - from).norm() >= apart && (!best || candidate.score() > best->score())) best = candidate;
  return best;
}

void PlaceTrial::try_grid() {
  const std::array<int, 4> last = steps_within_reach();
  PlaceCandidate candidate;
  for (int x = -last[0]; x <= last[0]; ++x)
    for (int y = -last[1]; y <= last[1]; ++y)
      for (int z = -last[2]; z <= last[2]; ++z)
        for (int turn = -last[3]; turn <= last[3]; ++turn) {
          candidate.at = kCoarse * PlaceOffset(x, y, z, turn);
          grid_.push_back(candidate);
        }
  std::vector<Eigen::Matrix3d> rotations;
  for (int turn = -last[3]; turn <= last[3]; ++turn) rotations.push_back(rotation_at(kCoarse * turn));
  OldPlaneBox box;
  for (const Eigen::Vector3d& q : few_) try_point(q, rotations, box);
  for (PlaceCandidate& tried : grid_) complete(few_.size(), tried);
}

void PlaceTrial::try_point(const Eigen::Vector3d& q, const std::vector<Eigen::Matrix3d>& rotations, OldPlaneBox& box) {
  // The last place of the grid is the farthest one along all axes.
  const Eigen::Vector3d farthest = grid_.back().at.head<3>().array() + kCoarse;
  Eigen::AlignedBox3d reached;
  for (const Eigen::Matrix3d& rotation : rotations) {
    const Eigen::Vector3d point = rotation * q + pose_.translation;
    reached.extend(point - farthest).extend(point + farthest);
  }
  const bool gathered = map_.gather_old(reached, last_epoch_, box);
  if (gathered && box.empty()) return;
  const OldPlanes near{kCoarse, last_epoch_};
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    PlaceCandidate& candidate = grid_[i];
    const Eigen::Vector3d translation = pose_.translation + candidate.at.head<3>();
    const Eigen::Vector3d point = rotations[i % rotations.size()] * q + translation;
    const Plane* plane = gathered ? box.find(point, translation, kCoarse) : map_.find_old(point, translation, near);
    if (plane) candidate.fit += fit_of(*plane, point, kCoarse);
  }
}

PlaceCandidate PlaceTrial::refine(const PlaceOffset& from) const {
  PlaceCandidate best = judge(from);
  for (const int x : {-1, 0, 1})
    for (const int y : {-1, 0, 1})
      for (const int turn : {-1, 0, 1}) {
        const PlaceCandidate candidate = judge(from + 0.5 * kCoarse * PlaceOffset(x, y, 0.0, turn));
        if (candidate.score() > best.score()) best = candidate;
      }
  for (double step = 0.25 * kCoarse; step >= kFinestStep; step *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 4; ++k)
        for (const double sign : {-1.0, 1.0}) {
          const PlaceCandidate candidate = judge(best.at + sign * step * PlaceOffset::Unit(k));
          if (!(candidate.score() > best.score())) continue;
          best = candidate;
          better = true;
        }
    }
  return best;
}

PlaceCandidate PlaceTrial::judge(const PlaceOffset& at) const {
  const Eigen::Matrix3d rotation = rotation_at(at[3]);
  const Eigen::Vector3d translation = pose_.translation + at.head<3>();
  const OldPlanes near{kFine, last_epoch_};
  PlaceCandidate out;
  out.at = at;
  for (const Eigen::Vector3d& q : points_) {
    const Eigen::Vector3d point = rotation * q + translation;
    if (const Plane* plane = map_.find_old(point, translation, near)) out.fit += fit_of(*plane, point, kFine);
  }
  complete(points_.size(), out);
  return out;
}

Eigen::Matrix3d PlaceTrial::rotation_at(double turn) const {
  return (pose_.rotation * exp_so3(step({0.0, 0.0, 0.0, turn}).head<3>())).toRotationMatrix();
}

void PlaceTrial::complete(std::size_t points, PlaceCandidate& candidate) const {
  candidate.fit *= static_cast<double>(points_.size()) / static_cast<double>(points);
  candidate.told = kNatsPerPoint * candidate.fit;
  candidate.prior = log_prior(candidate.at.cwiseQuotient(sigmas_).squaredNorm());
}

std::array<int, 4> PlaceTrial::steps_within_reach() const {
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

}  // namespace allan_lio
