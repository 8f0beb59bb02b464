// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "allan_lio/lio/absolute_covariance.h"
#include "allan_lio/lio/lio_result.h"
#include "allan_lio/map/voxel_map.h"

namespace allan_lio {

/// Where a scan was found to fit the map from before.
struct Place {
  PoseVector step;           ///< of the pose: rotation in the IMU's frame [rad], translation in the world [m]
  std::uint32_t last_epoch;  ///< of the planes that it fits; what was made later may lie aside as the run did
};

class PlaceTrial;
struct PlaceCandidate;
struct WeighedPlace;

/// Looks whether a run that has drifted off old parts of its map is back at one of them, but aside.
///
/// Such a run makes its walls again where it sees them, matches those, and stays where it is; what it happens to match
/// of the old ones makes it sure of it. So once its position against some part was known to no better than 5 cm,
/// what the covariance says is not relied on any more: each look tries a scan of which too few points lie on old planes
/// at positions and headings around, up to ten of the largest sigma that there was, and two metres (correlative scan
/// matching: Olson, "Real-time correlative scan matching", ICRA 2009, eq. 1 to 3, with planes for its lookup table).
/// A place is believed if so many more points fit there than here, and than elsewhere, that it outweighs the prior,
/// Student's distribution with three degrees of freedom: what brings a run back aside are errors that its covariance
/// does not know. A pillar tells too little for that at one look; what successive looks from different places tell of
/// the same one, for it or against it, is added up, the prior once. (Which place a look speaks for, and which other one
/// it is compared with, is chosen with the prior.) Its steps are made for planes of half a metre (map/voxel_size) and
/// range noise of some centimetres.
class PlaceSearch {
 public:
  /// How much likelier a place is than the one at hand and than any other [nat].
  struct Odds {
    double over_here = 0.0, over_others = 0.0;
    Odds operator+(const Odds& more) const { return {over_here + more.over_here, over_others + more.over_others}; }
  };

  /// `points_imu`: the scan in the IMU's frame at the predicted `state` [m]; `absolute` has the covariance of that
  /// state against the parts of the map. Nothing if the scan fits here, if it fits nowhere or at several places, if
  /// too little is told of it yet, if nothing has drifted, or if the run is lost by more than two metres (1 sigma).
  /// Looks at one scan in half a second only, by their stamps.
  std::optional<Place> look(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state, const VoxelMap& map,
                            const AbsoluteCovariance& absolute, bool estimate_extrinsics);

  /// The map is begun anew.
  void forget() {
    drift_.reset();
    sighting_.reset();
  }

 private:
  struct Drift {
    Eigen::Vector4d sigmas;  ///< of the position in the world [m] and the heading [rad], the largest there were
    std::uint32_t last_epoch = 0;
    /// A place was found: what was made before, aside, is not what to look for.
    bool found_place = false;
  };

  /// A place that looks speak for which do not suffice alone.
  struct Sighting {
    Eigen::Vector3d shift;  ///< from the predicted position [m], world; the mean of the looks
    double turn;            ///< of the predicted heading [rad]; likewise
    int looks;
    Odds told;             ///< by all of them, without the prior
    Eigen::Vector3d from;  ///< where the last one that counted was taken [m]
    TimeNs stamp;          ///< of it
  };

  /// What is to be reckoned with by now. False if the run is lost.
  bool follow_drift(const LioState& state, const AbsoluteCovariance& absolute, bool estimate_extrinsics);
  /// Adds a look to those before. `speaks`: for what place this one does. That place if it is believed now.
  std::optional<PlaceCandidate> add_up(const std::optional<WeighedPlace>& speaks, const PlaceCandidate& here,
                                       PlaceTrial& trial, const LioState& state);

  std::optional<Drift> drift_;
  std::optional<Sighting> sighting_;
  std::optional<TimeNs> looked_at_;
};

}  // namespace allan_lio
