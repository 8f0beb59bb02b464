// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/lio_config.h"

#include <limits>

namespace allan_lio {
namespace {

using Range = ParameterRange;
constexpr bool kLive = true;

/// The bias of one sensor is told in one of three ways; which, check_noise_keys() sees to.
void declare_gyro_bias(ParameterVisitor& v, SensorNoise& gyro) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  v.optional_quantity({"imu/noise/gyro_bias_instability", "rad/s",
                       "sigma_bg, the Allan deviation on the flat part of the gyro's curve."},
                      gyro.bias_instability, 0.0, Dimension::kAngularRate, Range::positive());
  v.optional_quantity({"imu/noise/gyro_bias_random_walk", "rad/s^2/sqrt(Hz)",
                       "K_g, rate random walk, instead of bias_instability: kalibr's gyroscope_random_walk, or "
                       "FAST-LIO2's b_gyr_cov with the unit (rad/s^2)^2 and the rate."},
                      gyro.bias_random_walk, 0.0, Dimension::kGyroRandomWalk, Range::positive());
  v.optional_quantity({"imu/noise/gyro_bias_sigma", "rad/s",
                       "Steady-state standard deviation of a Gauss-Markov bias, instead of bias_instability."},
                      gyro.bias_sigma, 0.0, Dimension::kAngularRate, Range::positive());
  v.optional_quantity({"imu/noise/gyro_bias_time", "s",
                       "T_bg, correlation time of the gyro's bias: the averaging time of the flat part over 1.8926."},
                      gyro.bias_time, kNone, Dimension::kTime, Range::positive());
  Eigen::Vector3d flat = Eigen::Vector3d::Zero();
  v.optional_quantity({"imu/noise/gyro_bias_flat_time", "s",
                       "The averaging time at which the gyro's Allan deviation is flat, instead of bias_time."},
                      flat, 0.0, Dimension::kTime, Range::positive());
  if (!flat.isZero(0)) gyro.bias_time = flat.unaryExpr(&correlation_time_from_flat);
}

void declare_accel_bias(ParameterVisitor& v, SensorNoise& accel) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  v.optional_quantity({"imu/noise/accel_bias_instability", "m/s^2",
                       "sigma_ba, the Allan deviation on the flat part of the accelerometer's curve."},
                      accel.bias_instability, 0.0, Dimension::kAcceleration, Range::positive());
  v.optional_quantity({"imu/noise/accel_bias_random_walk", "m/s^3/sqrt(Hz)",
                       "K_a, acceleration random walk, instead of bias_instability: kalibr's "
                       "accelerometer_random_walk, or FAST-LIO2's b_acc_cov with the unit (m/s^3)^2 and the rate."},
                      accel.bias_random_walk, 0.0, Dimension::kAccelRandomWalk, Range::positive());
  v.optional_quantity({"imu/noise/accel_bias_sigma", "m/s^2",
                       "Steady-state standard deviation of a Gauss-Markov bias, instead of bias_instability."},
                      accel.bias_sigma, 0.0, Dimension::kAcceleration, Range::positive());
  v.optional_quantity({"imu/noise/accel_bias_time", "s",
                       "T_ba, correlation time of the accelerometer's bias: the averaging time of the flat part over "
                       "1.8926."},
                      accel.bias_time, kNone, Dimension::kTime, Range::positive());
  Eigen::Vector3d flat = Eigen::Vector3d::Zero();
  v.optional_quantity(
      {"imu/noise/accel_bias_flat_time", "s",
       "The averaging time at which the accelerometer's Allan deviation is flat, instead of bias_time."},
      flat, 0.0, Dimension::kTime, Range::positive());
  if (!flat.isZero(0)) accel.bias_time = flat.unaryExpr(&correlation_time_from_flat);
}

void declare_noise(ParameterVisitor& v, NoiseSpec& spec) {
  v.quantity({"imu/noise/gyro_white_noise", "rad/s/sqrt(Hz)",
              "N_g, angle random walk. Take it from the data sheet or an Allan deviation at 1 s."},
             spec.gyro.white, Dimension::kGyroWhiteNoise, Range::positive());
  v.quantity({"imu/noise/accel_white_noise", "m/s^2/sqrt(Hz)",
              "N_a, velocity random walk. Take it from the data sheet or an Allan deviation at 1 s."},
             spec.accel.white, Dimension::kAccelWhiteNoise, Range::positive());
  declare_gyro_bias(v, spec.gyro);
  declare_accel_bias(v, spec.accel);
  v.quantity({"imu/noise/gyro_turn_on_bias", "rad/s", "1 sigma of the gyro's constant bias at switch-on."},
             spec.gyro.turn_on_bias, Dimension::kAngularRate, Range::not_negative());
  v.quantity({"imu/noise/accel_turn_on_bias", "m/s^2", "1 sigma of the accelerometer's constant bias at switch-on."},
             spec.accel.turn_on_bias, Dimension::kAcceleration, Range::not_negative());
}

void declare_imu(ParameterVisitor& v, LioConfig::Imu& imu) {
  declare_noise(v, imu.spec);
  v.number(
      {"imu/k_g", "1",
       "Multiplier on the gyro's white noise N_g; 1 is the calibrated value. Raise it for vibration or scale error.",
       kLive},
      imu.scale.k_g, 1.0, Range::positive());
  v.number({"imu/k_a", "1",
            "Multiplier on the accelerometer's white noise N_a; 1 is the calibrated value. Raise it for vibration or "
            "scale error.",
            kLive},
           imu.scale.k_a, 1.0, Range::positive());
  v.number({"imu/k_gb", "1",
            "Multiplier on the gyro's bias instability sigma_bg; 1 is the calibrated value. Raise it when biases "
            "wander more than the specification says (temperature, g-sensitivity).",
            kLive},
           imu.scale.k_gb, 1.0, Range::positive());
  v.number({"imu/k_ab", "1",
            "Multiplier on the accelerometer's bias instability sigma_ba; 1 is the calibrated value. Raise it when "
            "biases wander more than the specification says (temperature, misalignment).",
            kLive},
           imu.scale.k_ab, 1.0, Range::positive());
  v.option(
      {"imu/bias_model", "",
       "random_walk holds the bias where it was last seen; gauss_markov lets it decay with its correlation time to "
       "a constant that is estimated too. Change it when the bias is known to be like that, at a steady "
       "temperature for one."},
      imu.bias_model, BiasModel::kRandomWalk, {"random_walk", "gauss_markov"});
  v.option({"imu/discretization", "",
            "How the continuous noise becomes the Q of an interval. Change it to compare the forms of the paper."},
           imu.discretization, Discretization::kTrapezoid, {"euler", "trapezoid", "discrete", "van_loan"});
  v.option({"imu/accel_unit", "",
            "Unit of the accelerometer's readings; auto tells g from m/s^2 by the median length of the first second. "
            "Change it when the start is violent."},
           imu.accel_unit, AccelUnit::kAuto, {"auto", "m/s^2", "g"});
  v.number({"imu/gravity", "m/s^2",
            "Local gravity. Change it to your latitude's value when the bias of the vertical accelerometer matters."},
           imu.gravity, 9.80665, Range::between(9.7, 9.9));
  v.number(
      {"imu/accel_range", "m/s^2",
       "Full scale of the accelerometer; a reading at or above it counts as saturated and gets inflated noise.", kLive},
      imu.accel_range, 156.9, Range::positive());
  v.number({"imu/gyro_range", "rad/s",
            "Full scale of the gyro; a reading at or above it counts as saturated and gets inflated noise.", kLive},
           imu.gyro_range, 34.9, Range::positive());
  v.number(
      {"imu/max_gap", "s",
       "Longest silence of the IMU, with no scan that fits in it either, that is bridged; past it the estimator starts "
       "again where it stood. Change it when the links are known to stall.",
       kLive},
      imu.max_gap, 1.0, Range::positive());
}

void declare_lidar(ParameterVisitor& v, LioConfig::Lidar& lidar) {
  v.flag({"lidar/deskew", "",
          "Move every point to the scan's end by its own time. Turn it off only for clouds that are already motion "
          "compensated or have no times."},
         lidar.deskew, true);
  v.option({"lidar/point_time", "",
            "What a point's time counts from: the sweep's start at the header stamp, its end at the header stamp, or "
            "the clock's epoch; auto tells by the first scan. For clouds without times, of a LiDAR that spins evenly "
            "and whose points come in the order of firing, they can be made from the azimuth, from the header stamp "
            "on, by the way that it turns seen from above (a Velodyne's is azimuth_clockwise). The first point is then "
            "at the stamp, whatever rays met nothing before it."},
           lidar.point_time, PointTime::kAuto,
           {"auto", "start", "end", "absolute", "azimuth_clockwise", "azimuth_counterclockwise"});
  v.option({"lidar/time_unit", "",
            "Unit of the point-time field; auto tells by the first scan. Change it when the verdict printed at start "
            "is wrong."},
           lidar.time_unit, TimeUnit::kAuto, {"auto", "s", "ms", "us", "ns"});
  v.text({"lidar/time_field", "",
          "Name of the point-time field; empty: t, time, timestamp, time_stamp or offset_time, whichever is there. "
          "Change it for a driver of your own."},
         lidar.time_field, "");
  v.number({"lidar/turn_time", "s", "Duration of a turn, for point_time: azimuth_... only."}, lidar.turn_time, 0.1,
           Range::between(0.01, 1.0));
  v.flag({"lidar/drop_tagged", "",
          "Drop the points that a Livox marks as noise (field tag, uint8: bit 5, as FAST-LIO2 drops them). Turn it off "
          "to keep third returns and points of low confidence."},
         lidar.drop_tagged, true);
  v.number({"lidar/time_offset", "s",
            "Added to the LiDAR's stamps to reach the IMU's clock. Change it when the two are not synchronised."},
           lidar.time_offset, 0.0, Range::between(-1.0, 1.0));
  v.number({"lidar/min_range", "m", "Points nearer are dropped. Raise it past the robot's own body."}, lidar.min_range,
           0.5, Range::not_negative());
  v.number({"lidar/max_range", "m", "Points farther are dropped. Lower it where far points are unreliable."},
           lidar.max_range, 100.0, Range::positive());
  v.number({"lidar/range_noise", "m", "1 sigma of a range measurement, from the LiDAR's data sheet."},
           lidar.range_noise, 0.02, Range::positive());
  v.number({"lidar/k_r", "1",
            "Multiplier on a point's noise (range_noise, beam_divergence, or the surface's roughness where it is "
            "larger); 1 is as stated. Raise it for moving surroundings.",
            kLive},
           lidar.k_r, 1.0, Range::positive());
  v.number({"lidar/beam_divergence", "rad",
            "Full angle of a beam, from the LiDAR's data sheet: at grazing incidence its spot is long and the range "
            "uncertain. 0 leaves that out."},
           lidar.beam_divergence, 0.0, Range::between(0.0, 0.2));
  v.number(
      {"lidar/leaf", "m",
       "Width of the cells of beam direction of which one point each is registered. Raise it for speed, lower it in "
       "narrow places."},
      lidar.leaf, 0.4, Range::between(0.01, 10.0));
  v.integer({"lidar/min_points", "1", "A scan with fewer points after downsampling is not used; the IMU goes on alone.",
             kLive},
            lidar.min_points, 50, Range::between(1, 1e6));
  v.integer(
      {"lidar/max_registered", "1",
       "Most points of a scan that are registered after downsampling, spread evenly over its time; 0: all. Set it "
       "on a slow computer: it bounds what the update of a scan takes, lidar/leaf sets what it takes on average.",
       kLive},
      lidar.max_registered, 0, Range::between(0, 1e6));
}

/// `key`/translation and `key`/rotation, each with its sentence; the default is the identity.
void declare_transform(ParameterVisitor& v, const std::string& key, const std::string& origin, const std::string& turn,
                       RigidTransform& transform) {
  Eigen::VectorXd rotation(4), translation(3);
  rotation << transform.rotation.coeffs();
  translation << transform.translation;
  v.numbers({key + "/translation", "m", origin}, translation, Eigen::VectorXd::Zero(3), {});
  v.numbers({key + "/rotation", "1", turn}, rotation, Eigen::Vector4d(0, 0, 0, 1), Range::between(-1.001, 1.001));
  transform.rotation.coeffs() = rotation;
  transform.translation = translation;
}

void declare_extrinsics(ParameterVisitor& v, LioConfig& c) {
  declare_transform(v, "extrinsics/T_imu_lidar", "The LiDAR's origin in the IMU frame: p_imu = T_imu_lidar * p_lidar.",
                    "Quaternion x, y, z, w of the rotation from the LiDAR frame to the IMU frame.", c.T_imu_lidar);
  declare_transform(v, "extrinsics/T_base_imu",
                    "The IMU's origin in the robot's frame: p_base = T_base_imu * p_imu. Odometry and TF are of "
                    "frames/base by it; trajectory.tum and states.csv are the IMU's whatever it is.",
                    "Quaternion x, y, z, w of the rotation from the IMU frame to the robot's frame.", c.T_base_imu);
  v.flag({"extrinsics/estimate", "",
          "Estimate T_imu_lidar along with the motion. Turn it on with a rich scene and motion about all axes, and "
          "copy the result."},
         c.estimate_extrinsics, false);
  v.number({"extrinsics/rotation_sigma", "rad", "1 sigma of the given rotation, used when it is estimated."},
           c.extrinsic_rotation_sigma, 0.02, Range::positive());
  v.number({"extrinsics/translation_sigma", "m", "1 sigma of the given translation, used when it is estimated."},
           c.extrinsic_translation_sigma, 0.03, Range::positive());
}

void declare_map(ParameterVisitor& v, LioConfig::Map& map) {
  v.option({"map/structure", "",
            "planes keeps one growing plane per voxel, points keeps points and fits a plane to the nearest. Change it "
            "to compare (doc/decisions.md)."},
           map.structure, MapStructure::kPlanes, {"planes", "points"});
  v.number({"map/voxel_size", "m", "Edge of the map's voxels. Raise it outdoors, lower it in cluttered rooms."},
           map.voxel_size, 0.5, Range::between(0.05, 20.0));
  v.number({"map/insert_leaf", "m", "Width of the cells of beam direction of which one point each enters the map."},
           map.insert_leaf, 0.1, Range::between(0.001, 5.0));
  v.number({"map/insert_distance", "m",
            "A scan enters the map when the sensor has moved this far since the last one that did. Raise it for a slow "
            "vehicle with a fast LiDAR.",
            kLive},
           map.insert_distance, 0.05, Range::not_negative());
  v.number({"map/insert_angle", "rad", "Or when it has turned by this much.", kLive}, map.insert_angle, 0.01,
           Range::not_negative());
  v.number(
      {"map/radius", "m",
       "Voxels farther than this from the LiDAR are forgotten when the map is full. Keep it above the LiDAR's range."},
      map.radius, 150.0, Range::positive());
  v.number({"map/max_mb", "MB", "Hard cap of the map's memory; the farthest voxels go first."}, map.max_mb, 300.0,
           Range::between(1.0, 1e6));
}

void declare_update(ParameterVisitor& v, LioConfig::Update& update) {
  v.integer({"update/max_iterations", "1", "Most iterations of the Kalman update in a scan.", kLive},
            update.max_iterations, 6, Range::between(1, 50));
  v.number({"update/rotation_tolerance", "rad",
            "The iterations stop when the step's rotation and translation are both below tolerance.", kLive},
           update.rotation_tolerance, 1e-4, Range::positive());
  v.number({"update/translation_tolerance", "m",
            "The iterations stop when the step's rotation and translation are both below tolerance.", kLive},
           update.translation_tolerance, 1e-4, Range::positive());
  v.number({"update/gate", "sigma",
            "A residual beyond this many standard deviations of its own noise and the pose's is not used. Raise it "
            "when the start is rough.",
            kLive},
           update.gate, 3.0, Range::positive());
  v.number({"update/robust_scale", "sigma",
            "Residuals beyond this many standard deviations are down-weighted (Huber). Lower it among moving objects.",
            kLive},
           update.robust_scale, 2.0, Range::positive());
  v.number({"update/support_floor", "1",
            "A direction of the pose is left to the IMU unless the LiDAR's information along it is probably above this "
            "many times what the noise of the map's normals feigns.",
            kLive},
           update.support_floor, 4.0, Range::not_negative());
  v.flag({"update/relocalize", "",
          "A run that has drifted by 5 cm (1 sigma) looks for its old map beside, by up to ten sigma and 2 m, and sets "
          "itself right there (structure: planes). Turn it off if the pose must not jump."},
         update.relocalize, true);
}

void declare_init(ParameterVisitor& v, LioConfig::Init& init) {
  v.number({"init/standstill_time", "s",
            "Length of the standstill at the start from which tilt and biases are taken. Raise it for a better start, "
            "if the robot stands that long."},
           init.standstill_time, 1.0, Range::between(0.05, 4.0));
  v.number({"init/gyro_still", "rad/s",
            "Standard deviation of the gyro above which the start counts as moving. Raise it for a vibrating robot "
            "that stands."},
           init.gyro_still, 0.02, Range::positive());
  v.number({"init/accel_still", "m/s^2",
            "Standard deviation of the accelerometer above which the start counts as moving. Raise it for a vibrating "
            "robot that stands."},
           init.accel_still, 0.15, Range::positive());
  v.number({"init/velocity_sigma", "m/s",
            "1 sigma of the velocity at any other start. Raise it for a start on the motorway."},
           init.velocity_sigma, 10.0, Range::positive());
  v.number({"init/still_velocity_sigma", "m/s",
            "1 sigma of the velocity of a start whose IMU is quiet and to which the LiDAR does not object. Raise it "
            "when the start may be a "
            "steady ride down a tunnel."},
           init.still_velocity_sigma, 0.05, Range::positive());
  v.flag(
      {"init/hold_standstill", "",
       "For as long as the robot goes on standing where it started, and its IMU reads nothing but noise, take it for "
       "standing still. Turn it off if that may be a steady ride."},
      init.hold_standstill, true);
  v.number({"init/moving_time", "s", "Length of the record from which tilt is taken when the start is moving."},
           init.moving_time, 0.2, Range::between(0.01, 10.0));
  v.number({"init/moving_accel_sigma", "m/s^2",
            "1 sigma of the mean acceleration of a moving start; makes the tilt's uncertainty."},
           init.moving_accel_sigma, 1.0, Range::positive());
}

void declare_frames(ParameterVisitor& v, LioConfig::Frames& frames) {
  v.text({"frames/odom", "", "Name of the world frame that is published."}, frames.odom, "odom");
  v.text({"frames/base", "", "Name of the robot's frame that odometry and TF refer to."}, frames.base, "base_link");
  v.text({"frames/imu", "",
          "Name of the IMU's frame; T_base_imu is looked up in TF when it differs from frames/base and "
          "extrinsics_from_tf is set, else it is extrinsics/T_base_imu."},
         frames.imu, "imu");
  v.text({"frames/lidar", "", "Name of the LiDAR's frame, for the look-up of extrinsics in TF."}, frames.lidar,
         "lidar");
  v.flag({"frames/publish_tf", "",
          "Publish odom -> base_link in TF. Turn it off when another node (robot_localization) does."},
         frames.publish_tf, true);
  v.flag({"frames/extrinsics_from_tf", "",
          "Take T_imu_lidar and T_base_imu from TF at start instead of from the configuration."},
         frames.extrinsics_from_tf, false);
}

}  // namespace

void declare_parameters(ParameterVisitor& v, LioConfig& c) {
  v.text({"topics/imu", "", "Topic of sensor_msgs/Imu."}, c.topics.imu, "/imu/data");
  v.text({"topics/lidar", "",
          "Topic of sensor_msgs/PointCloud2, or of CustomMsg of livox_ros_driver or livox_ros_driver2."},
         c.topics.lidar, "/points");
  declare_imu(v, c.imu);
  declare_lidar(v, c.lidar);
  declare_extrinsics(v, c);
  declare_map(v, c.map);
  declare_update(v, c.update);
  declare_init(v, c.init);
  declare_frames(v, c.frames);
  v.integer({"threads", "1", "Threads of the registration. The result does not depend on it."}, c.threads, 1,
            Range::between(1, 64));
  v.integer({"realtime_priority", "1",
             "Real-time priority (SCHED_FIFO) of the thread that propagates at the rate of the IMU and of the one that "
             "reads its socket, where the system allows it; 0: none."},
            c.realtime_priority, 1, Range::between(0, 99));
}

}  // namespace allan_lio
