// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "allan_lio/lidar/deskew.h"
#include "allan_lio/lidar/scan_downsample.h"
#include "allan_lio/lio/iterated_update.h"
#include "allan_lio/lio/odometry.h"
#include "allan_lio/lio/place_search.h"
#include "allan_lio/lio/standstill.h"
#include "allan_lio/lio/synchronizer.h"
#include "allan_lio/lio/zero_velocity.h"
#include "allan_lio/map/voxel_map.h"

namespace allan_lio {

/// The state of the odometry and the stages that process() calls, in the order of the pipeline.
class Odometry::Impl {
 public:
  explicit Impl(const LioConfig& config);

  std::optional<LioResult> next();
  LioResult process(Scan scan);

  /// Settles unit, tilt, biases and their covariance once the IMU's data spans the record that this takes.
  bool initialize_from_imu();
  /// Tells the accelerometer's unit by the readings over [from, until]. True if some are absurd in it, and now gone:
  /// before the unit is known the gate has to take all for m/s^2.
  bool settle_accel_scale(TimeNs from, TimeNs until);
  /// The readings over [from, until], as far as there are any, accelerations by the scale in force.
  std::vector<ImuSample> scaled_record(TimeNs from, TimeNs until) const;

  /// Moves state and covariance to `t`; returns the motion in between.
  std::vector<TrackSegment> propagate_to(TimeNs t);
  /// Of the motion between two readings: more where one is saturated, or where samples are missing around them.
  ImuNoise noise_between(const ImuSample& from, const ImuSample& to);
  /// Over the whole of an interval.
  void propagate_covariance(const NavMatrix& transition, const NavMatrix& noise);
  /// The longest silence of the IMU since the last update, up to `t`.
  ImuBuffer::Silence blind_until(TimeNs t) const;
  /// After a silence that nothing bridges: starts as at a start, but where it stood and as it knew its biases, and
  /// with what may have happened in the meantime. Takes back the scan at hand.
  void start_in_place(const ImuBuffer::Silence& silence, Scan scan);

  void select_points(const Scan& scan);
  /// `reference`: where the track ends.
  Deskewer make_deskewer(const Scan& scan, const std::vector<TrackSegment>& track, const NavState& reference) const;
  void deskew_points(const Scan& scan);
  void insert_scan();
  void clear_map();
  /// Points that are added from one place share one pose's error: a standing sensor would make its own yardstick.
  bool moved_since_insertion() const;
  /// A scan without matches: it adds to a map to which none was registered yet; of a map that was good before, too
  /// many in a row start it anew here.
  ScanOutcome settle_unmatched();

  /// Lays the world so that the state's position and heading are those of start_: at a first start its origin.
  void make_first_pose();
  /// The map is about to be founded: of the run's error there is only what the start left.
  void reset_absolute();
  /// The map is about to be founded at this pose, so it is known exactly: its uncertainty goes over to velocity and
  /// gravity, which are known relative to the body.
  void anchor_pose();
  /// The map is the LiDAR's: when the extrinsics are estimated it is the LiDAR's pose that is known exactly, and the
  /// IMU's is as uncertain as the extrinsics.
  void anchor_lidar_pose();

  /// Updates by the scan at hand; where the run has come back aside of its map, from the place that it fits there.
  UpdateReport register_scan(const Scan& scan, LioResult& result);

  /// True at the second scan of a start whose IMU is quiet.
  bool may_stand_still() const { return quiet_start_ && scans_processed_ == 1; }
  /// Takes the velocity for zero unless the scan shows motion.
  void settle_standstill();
  /// While the first start's standstill lasts, the state is held where it began. True if it was.
  bool hold_standstill();

  /// True in the first scans of a moving start: the velocity at hand when the scan was deskewed was so wrong that
  /// the map's first points are smeared by more than their noise.
  bool is_distorted(const Scan& scan, const Eigen::Vector3d& predicted_velocity) const;
  /// Starts the map anew with this scan, deskewed with the velocity that is known now.
  void found_map_again(const Scan& scan, std::vector<TrackSegment> track);

  LioResult begin_result(const Scan& scan) const;
  static void describe(const UpdateReport& report, LioResult& result);
  LioResult finish(ScanOutcome outcome, Scan scan, LioResult result);

  std::vector<WorldPoint> deskewed_points() const;
  std::vector<WorldPoint> map_points() const;
  void reconfigure(const LioConfig& config);
  void set_pose(const PoseAnchor& anchor);

  LioConfig config_;
  ImuNoise noise_;
  LioCounters counters_;
  Synchronizer synchronizer_;
  ScanDownsampler downsampler_;
  std::unique_ptr<VoxelMap> map_;
  TaskPool pool_;
  PointToPlane residuals_;

  static constexpr int kSettlingScans = 10;  ///< after which the start counts as settled

  /// What a start begins with: nothing but the specification at the first one.
  struct Start {
    bool again = false;
    RigidTransform T_world_imu;                                     ///< of which position and heading are kept
    Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();  ///< [m^2]
    double heading_variance = 0.0;                                  ///< [rad^2]
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
    NoiseSpec spec;  ///< its turn-on biases are what is not known of these biases
  };
  Start start_;

  bool initialized_ = false;
  bool quiet_start_ = false;
  Standstill standstill_;
  bool held_ = false;          ///< a scan of it was
  RigidTransform first_pose_;  ///< T_world_imu where the map was founded
  double accel_scale_ = 1.0;
  LioState state_;
  Belief belief_;
  AbsoluteCovariance absolute_;
  PlaceSearch places_;
  TimeNs updated_at_ = 0;                           ///< stamp of the last update
  TimeNs started_at_ = 0;                           ///< stamp at which the state was made from the IMU alone
  Eigen::Vector3d gyro_ = Eigen::Vector3d::Zero();  ///< at the state's stamp, bias off [rad/s]
  int scans_processed_ = 0;
  int unmatched_in_a_row_ = 0;
  bool map_proven_ = false;     ///< a scan has been registered to the map as it is
  RigidTransform inserted_at_;  ///< T_world_imu of the scan that was last put into the map

  // Of the scan at hand; kept for deskewed_points() and so that nothing is allocated anew for every scan.
  Scan scan_;
  std::optional<Deskewer> deskewer_;
  std::vector<std::uint32_t> inserted_;             ///< indices into the scan: the points for the map
  std::vector<std::uint32_t> registered_;           ///< indices into the scan: the points for the update
  std::vector<Eigen::Vector3f> inserted_points_;    ///< deskewed, IMU frame at the scan's end [m]
  std::vector<Eigen::Vector3f> registered_points_;  ///< the same
  std::vector<Eigen::Vector3d> world_points_;       ///< [m]
};

}  // namespace allan_lio
