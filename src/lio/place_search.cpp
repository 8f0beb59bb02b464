// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/place_search.h"

#include "allan_lio/lio/drift.h"
#include "place_trial.h"

namespace allan_lio {

using Odds = PlaceSearch::Odds;

/// A place and how much likelier it is than others, by what the points tell and by the prior.
struct WeighedPlace {
  PlaceCandidate place;
  Odds told, prior;
};

namespace {

constexpr double kEvery = 0.45;  ///< [s]
constexpr std::size_t kLeastPoints = 40;
constexpr double kApart = 0.5;         ///< [m]; what is nearer is the same place
constexpr double kLeastShare = 0.3;    ///< of the points that have to fit at a place
constexpr double kIsBack = 0.6;        ///< of the points: the run is where it takes itself to be
constexpr Odds kOneLook = {8.0, 4.0};  ///< from which a place is believed
constexpr Odds kLooks = {20.0, 10.0};  ///< that several looks together need: they see much the same
constexpr double kOfUse = 3.0;         ///< [nat] from which a look speaks for a place
constexpr double kTogether = 3.0;      ///< [s] within which the next one has to do so
constexpr double kMoved = 0.25;        ///< [m]; from nearer the same is seen again

bool outweighs(const Odds& odds, const Odds& needed) {
  return odds.over_here >= needed.over_here && odds.over_others >= needed.over_others;
}

Eigen::Vector4d sigmas_of(const PoseMatrix& covariance, const LioState& state) {
  const Eigen::Vector3d up = state.nav.T_world_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Vector4d out;
  out << covariance.diagonal().tail<3>(), up.dot(covariance.topLeftCorner<3, 3>() * up);
  return out.cwiseMax(0.0).cwiseSqrt();
}

/// The best coarse step, refined if enough points fit there and it is not none.
PlaceCandidate best_of(PlaceTrial& trial) {
  const PlaceCandidate coarse = *trial.best_on_grid(PlaceOffset::Zero(), 0.0);
  const bool fits = coarse.fit >= kLeastShare * static_cast<double>(trial.points());
  return fits && !coarse.at.isZero(0.0) ? trial.refine(coarse.at) : coarse;
}

WeighedPlace weigh(const PlaceCandidate& place, const PlaceCandidate& here, PlaceTrial& trial) {
  const double over_here = place.told - here.told;
  WeighedPlace out{place, {over_here, over_here}, {place.prior - here.prior, 0.0}};
  const std::optional<PlaceCandidate> apart = trial.best_on_grid(place.at, kApart);
  if (!apart) return out;
  const PlaceCandidate other = trial.refine(apart->at);
  if ((other.at - place.at).norm() > PlaceTrial::kCoarse) {
    out.told.over_others = place.told - other.told;
    out.prior.over_others = place.prior - other.prior;
  }
  return out;
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

  PlaceTrial trial(points_imu, state, map, drift_->last_epoch, drift_->sigmas);
  if (trial.points() < kLeastPoints) return std::nullopt;
  const double points = static_cast<double>(trial.points());
  const PlaceCandidate here = trial.judge(PlaceOffset::Zero());
  if (here.fit > kIsBack * points) {
    sighting_.reset();
    return std::nullopt;
  }
  const PlaceCandidate best = best_of(trial);
  const bool fits = best.fit >= kLeastShare * points;
  if (fits && best.at.norm() < PlaceTrial::kFine) {
    sighting_.reset();
    return std::nullopt;
  }
  std::optional<WeighedPlace> speaks;
  if (fits && best.told - here.told >= kOfUse) speaks = weigh(best, here, trial);
  std::optional<PlaceCandidate> found = add_up(speaks, here, trial, state);
  if (speaks && outweighs(speaks->told + speaks->prior, kOneLook)) found = speaks->place;
  if (!found) return std::nullopt;
  sighting_.reset();
  drift_->found_place = true;
  return Place{trial.step(found->at), drift_->last_epoch};
}

std::optional<PlaceCandidate> PlaceSearch::add_up(const std::optional<WeighedPlace>& speaks, const PlaceCandidate& here,
                                                  PlaceTrial& trial, const LioState& state) {
  const Eigen::Vector3d& position = state.nav.T_world_imu.translation;
  if (sighting_ && seconds_between(sighting_->stamp, state.nav.stamp) > kTogether) sighting_.reset();
  if (sighting_) {
    Sighting& sighting = *sighting_;
    if ((position - sighting.from).norm() < kMoved) return std::nullopt;
    PlaceOffset at;
    at << sighting.shift, sighting.turn * trial.lever();
    const bool again = speaks && (speaks->place.at - at).norm() < PlaceTrial::kCoarse;
    const WeighedPlace weighed = again ? *speaks : weigh(trial.refine(at), here, trial);
    sighting.told = sighting.told + weighed.told;
    sighting.from = position;
    if (sighting.told.over_here > 0.0 && sighting.told.over_others > 0.0) {
      if (!again) return std::nullopt;
      ++sighting.looks;
      sighting.shift += (speaks->place.at.head<3>() - sighting.shift) / sighting.looks;
      sighting.turn += (speaks->place.at[3] / trial.lever() - sighting.turn) / sighting.looks;
      sighting.stamp = state.nav.stamp;
      return outweighs(sighting.told + weighed.prior, kLooks) ? std::make_optional(speaks->place) : std::nullopt;
    }
    sighting_.reset();
  }
  if (speaks && speaks->told.over_others > 0.0)
    sighting_ = Sighting{
        speaks->place.at.head<3>(), speaks->place.at[3] / trial.lever(), 1, speaks->told, position, state.nav.stamp};
  return std::nullopt;
}

}  // namespace allan_lio
