// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "allan_lio/imu/discretize.h"
#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/io/parameter_visitor.h"
#include "allan_lio/math/rigid_transform.h"

namespace allan_lio {

enum class AccelUnit { kAuto, kMetresPerSecondSquared, kG };
enum class PointTime { kAuto, kStart, kEnd, kAbsolute, kAzimuthClockwise, kAzimuthCounterclockwise };
enum class TimeUnit { kAuto, kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };
enum class MapStructure { kPlanes, kPoints };

/// Everything that a run depends on. Fields are set by declare_parameters() and nowhere else:
/// make one with default_config() or by reading a source (config_source.h).
struct LioConfig {
  struct Topics {
    std::string imu, lidar;
  } topics;

  struct Imu {
    NoiseSpec spec;
    NoiseScale scale;
    BiasModel bias_model;
    Discretization discretization;
    AccelUnit accel_unit;
    double gravity;      ///< [m/s^2]
    double accel_range;  ///< saturation [m/s^2]
    double gyro_range;   ///< saturation [rad/s]
    double max_gap;      ///< [s]
  } imu;

  struct Lidar {
    bool deskew;
    PointTime point_time;    ///< what the point-time field counts from
    TimeUnit time_unit;      ///< its unit
    std::string time_field;  ///< its name; empty: found
    double turn_time;        ///< of a spinning LiDAR, for the times by azimuth [s]
    bool drop_tagged;        ///< what Livox's tag calls noise
    double time_offset;      ///< added to the LiDAR's stamps to reach the IMU's clock [s]
    double min_range;        ///< [m]
    double max_range;        ///< [m]
    double range_noise;      ///< 1 sigma [m]
    double k_r;              ///< multiplier of a point's noise
    double beam_divergence;  ///< full angle [rad]
    double leaf;             ///< width of the registration's downsampling cells [m]
    int min_points;          ///< a scan with fewer is not used
    int max_registered;      ///< most points of a scan that are registered; 0: all
  } lidar;

  RigidTransform T_imu_lidar;
  RigidTransform T_base_imu;  ///< of what is published; the files are of the IMU
  bool estimate_extrinsics;
  double extrinsic_rotation_sigma;     ///< [rad]
  double extrinsic_translation_sigma;  ///< [m]

  struct Map {
    MapStructure structure;
    double voxel_size;       ///< [m]
    double insert_leaf;      ///< width of the cells of the downsampling before insertion [m]
    double insert_distance;  ///< [m]
    double insert_angle;     ///< [rad]
    double radius;           ///< [m]
    double max_mb;           ///< [MB]
  } map;

  struct Update {
    int max_iterations;
    double rotation_tolerance;     ///< [rad]
    double translation_tolerance;  ///< [m]
    double gate;                   ///< [sigma]
    double robust_scale;           ///< [sigma]
    double support_floor;          ///< [1]
    bool relocalize;               ///< look for an old place when drifted (PlaceSearch)
  } update;

  struct Init {
    double standstill_time;       ///< [s]
    double gyro_still;            ///< [rad/s]
    double accel_still;           ///< [m/s^2]
    double velocity_sigma;        ///< [m/s]
    double still_velocity_sigma;  ///< [m/s]
    bool hold_standstill;         ///< for as long as it lasts
    double moving_time;           ///< [s]
    double moving_accel_sigma;    ///< [m/s^2]
  } init;

  struct Frames {
    std::string odom, base, imu, lidar;
    bool publish_tf;
    bool extrinsics_from_tf;
  } frames;

  int threads;
  int realtime_priority;  ///< SCHED_FIFO, 1 to 99, of the propagation at the rate of the IMU; 0: none
};

/// The one declaration of every parameter: key, default, unit, range and sentence.
void declare_parameters(ParameterVisitor& visitor, LioConfig& config);

}  // namespace allan_lio
