// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/publish.h"

#include <allan_lio/State.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <visualization_msgs/MarkerArray.h>

#include <boost/make_shared.hpp>

#include "allan_lio/io/config_source.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/finite.h"
#include "allan_lio/ros/markers.h"
#include "allan_lio/ros/state_message.h"
#include "allan_lio/ros/stopped_at_start.h"

namespace allan_lio {
namespace {

/// ~path keeps a pose every kPathStep [m], and every other one of them when it has kPathPoses: a message per scan
/// must not grow without bound.
constexpr double kPathStep = 0.1;
constexpr std::size_t kPathPoses = 10000;

RigidTransform look_up(const tf2_ros::Buffer& buffer, const std::string& target, const std::string& source,
                       double patience) {
  if (target == source) return {};
  const ros::WallTime until = ros::WallTime::now() + ros::WallDuration(patience);
  // tf2's own waiting counts in ROS time, which stands still until a simulated clock comes.
  for (std::string why; !buffer.canTransform(target, source, ros::Time(0), &why); why.clear()) {
    require_running();
    if (ros::WallTime::now() > until)
      throw ConfigError("frames/extrinsics_from_tf: no transform from '" + source + "' to '" + target + "' within " +
                        std::to_string(static_cast<int>(patience)) + " s: " + why);
    ros::WallDuration(0.02).sleep();
  }
  return from_transform(buffer.lookupTransform(target, source, ros::Time(0)).transform);
}

}  // namespace

RigidTransform resolve_extrinsics(LioConfig& config, double patience) {
  if (!config.frames.extrinsics_from_tf) return config.T_base_imu;
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  config.T_imu_lidar = look_up(buffer, config.frames.imu, config.frames.lidar, patience);
  config.T_base_imu = look_up(buffer, config.frames.base, config.frames.imu, patience);
  return config.T_base_imu;
}

Eigen::Vector3d gyro_reading_variance(const LioConfig::Imu& imu, double sample_interval) {
  if (!(sample_interval > 0.0)) return Eigen::Vector3d::Zero();
  return make_imu_noise(imu.spec, imu.scale, imu.bias_model).gyro_psd / sample_interval;
}

LioPublisher::LioPublisher(ros::NodeHandle private_handle, const LioConfig& config, const RigidTransform& T_base_imu)
    : config_(config),
      T_base_imu_(T_base_imu),
      odometry_(private_handle.advertise<nav_msgs::Odometry>("odometry", 100)),
      path_(private_handle.advertise<nav_msgs::Path>("path", 2)),
      points_(private_handle.advertise<sensor_msgs::PointCloud2>("points", 4)),
      map_(private_handle.advertise<sensor_msgs::PointCloud2>("map", 1, true)),
      state_(private_handle.advertise<State>("state", 100)),
      markers_(private_handle.advertise<visualization_msgs::MarkerArray>("markers", 4)) {
  track_.header.frame_id = config.frames.odom;
}

void LioPublisher::publish(const LioResult& result, const LioSession& session) {
  newest_ = result.state.nav.stamp;
  BaseEstimate estimate;
  estimate.state = result.state.nav;
  estimate.covariance = result.covariance.topLeftCorner<kNavDof, kNavDof>();
  estimate.gyro = result.gyro;
  estimate.gyro_variance = gyro_reading_variance(session.odometry().config().imu, session.imu_interval());
  estimate.T_base_imu = T_base_imu_;
  const nav_msgs::OdometryPtr odometry = to_odometry(estimate, config_.frames.odom, config_.frames.base);
  const StatePtr state = to_state_message(result, session);
  // An estimate that is not finite in part is not published at all.
  if (!all_finite(*odometry) || !publish_finite(state_, state)) return;
  publish_finite(odometry_, odometry);
  if (markers_.getNumSubscribers() > 0) publish_finite(markers_, to_markers(result, config_.frames.odom));
  if (config_.frames.publish_tf) {
    geometry_msgs::TransformStamped transform;
    transform.header = odometry->header;
    transform.child_frame_id = odometry->child_frame_id;
    transform.transform = to_transform(base_pose(estimate));
    transforms_.sendTransform(transform);
  }
  extend_path(result);
  if (points_.getNumSubscribers() > 0)
    points_.publish(to_cloud(session.odometry().deskewed_points(), config_.frames.odom, newest_));
}

void LioPublisher::extend_path(const LioResult& result) {
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = to_ros_time(result.state.nav.stamp);
  pose.header.frame_id = config_.frames.odom;
  pose.pose = to_pose(result.state.nav.T_world_imu * T_base_imu_.inverse());
  if (pose.header.stamp < track_.header.stamp) track_.poses.clear();  // the estimator has started again
  track_.header.stamp = pose.header.stamp;
  const bool far = track_.poses.empty() ||
                   (from_point(track_.poses.back().pose.position) - from_point(pose.pose.position)).norm() >= kPathStep;
  if (far) track_.poses.push_back(pose);
  if (track_.poses.size() >= kPathPoses) {
    for (std::size_t i = 0; 2 * i < track_.poses.size(); ++i) track_.poses[i] = track_.poses[2 * i];
    track_.poses.resize((track_.poses.size() + 1) / 2);
  }
  if (path_.getNumSubscribers() > 0) path_.publish(boost::make_shared<nav_msgs::Path>(track_));
}

void LioPublisher::publish_map(const LioSession& session) {
  if (newest_ == map_stamp_ || map_.getNumSubscribers() == 0) return;
  map_.publish(to_cloud(session.odometry().map_points(), config_.frames.odom, newest_));
  map_stamp_ = newest_;
}

}  // namespace allan_lio
