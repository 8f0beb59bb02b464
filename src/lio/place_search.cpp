// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/place_search.h"

#include <utility>

#include "allan_lio/lio/drift.h"
#include "place_trial.h"

namespace allan_lio {
namespace {

using Odds = PlaceSearch::Odds;

constexpr double kEvery = 0.45;       ///< [s]
constexpr double kMayBeAside = 0.05;  ///< 1 sigma of the position [m], from which on a run is looked for
constexpr std::size_t kLeastPoints = 40;
constexpr double kApart = 0.5;         ///< [m]; what is nearer is the same place
constexpr double kLeastShare = 0.3;    ///< of the points that have to fit at a place
constexpr double kIsBack = 0.6;        ///< of the points: the run is where it takes itself to be
constexpr Odds kOneLook = {8.0, 4.0};  ///< from which a place is believed
constexpr Odds kLooks = {20.0, 10.0};  ///< that several looks together need: they see much the same
constexpr double kOfUse = 3.0;         ///< [nat] that one of them has to tell
constexpr double kTogether = 3.0;      ///< [s] within which the next one has to come

bool outweighs(const Odds& odds, const Odds& needed) {
  return odds.over_here >= needed.over_here && odds.over_others >= needed.over_others;
}

Eigen::Vector4d sigmas_of(const PoseMatrix& covariance, const LioState& state) {
  const Eigen::Vector3d up = state.nav.T_world_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Vector4d out;
  out << covariance.diagonal().tail<3>(), up.dot(covariance.topLeftCorner<3, 3>() * up);
  return out.cwiseMax(0.0).cwiseSqrt();
}

/// The best coarse step, refined if enough points fit there.
PlaceCandidate best_of(const PlaceTrial& trial) {
  const PlaceCandidate coarse = *trial.best_on_grid(PlaceOffset::Zero(), 0.0);
  return coarse.fit < kLeastShare * static_cast<double>(trial.points()) ? coarse : trial.refine(coarse.at);
}

/// By what the points tell, and by the prior.
std::pair<Odds, Odds> odds_of(const PlaceCandidate& best, const PlaceCandidate& here, const PlaceTrial& trial) {
  const double over_here = best.told - here.told;
  Odds told{over_here, over_here}, prior{best.prior - here.prior, 0.0};
  const std::optional<PlaceCandidate> apart = trial.best_on_grid(best.at, kApart);
  if (!apart) return {told, prior};
  const PlaceCandidate other = trial.refine(apart->at);
  if ((other.at - best.at).norm() > PlaceTrial::kCoarse) {
    told.over_others = best.told - other.told;
    prior.over_others = best.prior - other.prior;
  }
  return {told, prior};
}

}  // namespace

bool PlaceSearch::follow_drift(const LioState& state, const AbsoluteCovariance& absolute, bool estimate_extrinsics) {
  const std::vector<PoseMatrix> against_parts = absolute.relative_to_parts(state, estimate_extrinsics);
  const OldPlanes old = old_planes(against_parts, absolute.last_epochs(), kMayBeAside);
  if (old.reach == 0.0) return true;
  const Eigen::Vector4d sigmas = sigmas_of(*farthest_part(against_parts), state);
  if (!sigmas.allFinite() || sigmas.head<3>().maxCoeff() > PlaceTrial::kFarthest) return false;
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

  const PlaceTrial trial(points_imu, state, map, drift_->last_epoch, drift_->sigmas);
  if (trial.points() < kLeastPoints) return std::nullopt;
  const double points = static_cast<double>(trial.points());
  const PlaceCandidate here = trial.judge(PlaceOffset::Zero());
  if (here.fit > kIsBack * points) {
    sighting_.reset();
    return std::nullopt;
  }
  const PlaceCandidate best = best_of(trial);
  if (best.fit < kLeastShare * points) return std::nullopt;
  if (best.at.norm() < PlaceTrial::kFine) {
    sighting_.reset();
    return std::nullopt;
  }
  if (best.told - here.told < kOfUse) return std::nullopt;
  auto [told, prior] = odds_of(best, here, trial);
  const Odds alone = told + prior;
  if (sighting_ && (best.at - sighting_->at).norm() < PlaceTrial::kCoarse &&
      seconds_between(sighting_->stamp, state.nav.stamp) < kTogether)
    told = told + sighting_->told;
  sighting_ = Sighting{best.at, state.nav.stamp, told};
  if (!outweighs(alone, kOneLook) && !outweighs(told + prior, kLooks)) return std::nullopt;
  drift_->found_place = true;
  return Place{trial.step(best.at), drift_->last_epoch};
}

}  // namespace allan_lio
