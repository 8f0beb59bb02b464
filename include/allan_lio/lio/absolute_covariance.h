// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "allan_lio/lio/lio_result.h"
#include "allan_lio/lio/scan_error.h"

namespace allan_lio {

/// A scan's measurement of the pose, as the filter used it.
struct UsedMeasurement {
  LioState state;  ///< where it was linearised
  /// From the weighted gradient of the pose (1/rad, 1/m) to the state's error (SI units of LioIndex).
  Eigen::Matrix<double, kLioDof, 6> gain;
  PoseMatrix support;  ///< weighs information and gradient (support_factor)
  /// From the pose's error to the unweighed gradient, by part of the map [1/rad^2, 1/m^2]: its information, nothing
  /// along directions that are known not to be seen.
  std::vector<PoseMatrix> parts;
  PoseMatrix view_noise;  ///< covariance that ViewError went towards [rad^2, m^2]
  double view_kept;       ///< part of itself that ViewError kept
  ScanError scan;         ///< what deskewing added
};

/// The part of the square of an error of the pose (rotation [rad], translation [m]) that a covariance lacks to have it
/// for its sigma in that direction: 1 - e^T P e / |e|^4, or 0, with rotations as ways at ten metres. Not by e^T P^-1 e:
/// found again, an error is never quite the same, and what lies beside it is known well, so it would be added again.
double surprise(const PoseVector& error, const PoseMatrix& covariance);

/// The covariance of the run's error in the world of its first pose, whatever the filter believes.
///
/// The filter takes its map for true; that makes it track the surroundings well and is right for what is relative to
/// them: velocity, tilt, biases. But a plane lies where the pose's error put it when it was made, and this error comes
/// back with every scan that is registered to it. So this class follows the errors of state and map through the
/// filter's own gains (covariance analysis of a given filter, Joseph's form; Maybeck 1979, ch. 6; Gelb 1974, ch. 7).
/// The map's is the pose's error at some earlier times (stochastic clones): planes of about the same epoch share one.
class AbsoluteCovariance {
 public:
  static constexpr int kMaxParts = 8;

  /// As for a run that begins here: the map is about to be founded and has no error.
  void reset(const LioMatrix& covariance);
  /// The map starts anew somewhere on the way.
  void forget_map();

  const LioMatrix& state() const { return state_; }
  /// The epochs at which the parts of the map end, ascending.
  std::vector<std::uint32_t> last_epochs() const;

  /// Covariance of the LiDAR's pose (as one of the IMU's) against each part of the map.
  std::vector<PoseMatrix> relative_to_parts(const LioState& state, bool estimate_extrinsics) const;

  /// The pose turns out to err by `step` (rotation in the IMU's frame [rad], translation in the world [m]) since it
  /// left the part of the map that ends at `last_epoch`, and so do the parts made after that: the covariance becomes
  /// such that this is its sigma in that direction, if it is less (surprise()).
  void add_surprise(const PoseVector& step, const LioState& state, std::uint32_t last_epoch);

  /// The state's error goes over to T times itself.
  void transform(const LioMatrix& T);
  /// The same for a T of transport(): the error about another state.
  void move(const LioMatrix& T);
  /// Independent errors come on top.
  void add(const LioMatrix& noise) { state_ += noise; }

  /// The filter has moved its state by gain times the weighted gradient of a scan:
  ///   x+ = x - K (A_x x + A_m m - A n + noise), A = A_x = T sum_i I_i, A_m = -T (view: sum_i I_i; part i:
  ///   I_i), cov(noise) = A T^T
  /// with K the gain, T the support, I_i the parts and n the scan's error.
  void update(const UsedMeasurement& used, bool estimate_extrinsics);

  /// Points are put into the map at this pose. Returns the epoch to mark them with.
  std::uint32_t remember(const LioState& state, bool estimate_extrinsics);

 private:
  static constexpr int kMaxDof = 6 * (1 + kMaxParts);
  using Own = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDof, kMaxDof>;
  using Cross = Eigen::Matrix<double, kLioDof, Eigen::Dynamic, 0, kLioDof, kMaxDof>;

  struct Part {
    std::uint32_t last_epoch = 0;
    double epochs = 0.0;                                  ///< number of insertions
    Eigen::Vector3d reference = Eigen::Vector3d::Zero();  ///< what the error is about [m]
  };

  int dof() const { return 6 * (1 + static_cast<int>(parts_.size())); }
  /// Column of a part's error: rotation [rad] and translation [m] in the world; the view's error comes before them.
  static int column(std::size_t part) { return 6 * (1 + static_cast<int>(part)); }
  /// How much the errors of a part and of the next one differ [m^2].
  double difference(std::size_t first) const;
  void merge(std::size_t first);

  LioMatrix state_ = LioMatrix::Zero();
  Cross cross_ = Cross::Zero(kLioDof, 6);
  Own own_ = Own::Zero(6, 6);
  std::vector<Part> parts_;
  std::uint32_t epochs_ = 0;
};

}  // namespace allan_lio
