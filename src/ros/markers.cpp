// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/markers.h"

#include <Eigen/Eigenvalues>
#include <boost/make_shared.hpp>
#include <optional>

#include "allan_lio/lio/weak_axis.h"
#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

using visualization_msgs::Marker;

constexpr double kSigmas = 3.0;
constexpr double kThinnest = 0.005;  // [m]: an ellipsoid without volume is not drawn
constexpr double kBarLength = 4.0;   // [m]
constexpr double kBarWidth = 0.08;   // [m]

Marker marker(const LioResult& result, const std::string& frame, const char* name, int id, int type) {
  Marker out;
  out.header.stamp = to_ros_time(result.state.nav.stamp);
  out.header.frame_id = frame;
  out.ns = name;
  out.id = id;
  out.type = type;
  out.action = Marker::ADD;
  out.pose = to_pose({Eigen::Quaterniond::Identity(), result.state.nav.T_world_imu.translation});
  return out;
}

void paint(Marker& out, float red, float green, float blue, float opacity) {
  out.color.r = red;
  out.color.g = green;
  out.color.b = blue;
  out.color.a = opacity;
}

Marker ellipsoid(const LioResult& result, const std::string& frame) {
  Marker out = marker(result, frame, "position_3_sigma", 0, Marker::SPHERE);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(result.covariance.block<3, 3>(kPosition, kPosition));
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  out.pose.orientation = to_quaternion(Eigen::Quaterniond(axes));
  out.scale = to_vector((2.0 * kSigmas * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt()).cwiseMax(kThinnest));
  paint(out, 0.2F, 0.5F, 1.0F, 0.6F);
  return out;
}

Marker bar(const LioResult& result, const std::string& frame, int k) {
  Marker out = marker(result, frame, "weak_axes", k, Marker::LINE_LIST);
  const std::optional<WeakAxis> weak = weak_axis(result, k);
  if (!weak) {
    out.action = Marker::DELETE;
    return out;
  }
  const Eigen::Vector3d half = 0.5 * kBarLength * weak->axis;
  out.points = {to_point(-half), to_point(half)};
  out.scale.x = kBarWidth;
  paint(out, 1.0F, weak->turns ? 0.6F : 0.1F, 0.1F, 0.9F);
  return out;
}

}  // namespace

visualization_msgs::MarkerArrayPtr to_markers(const LioResult& result, const std::string& odom_frame) {
  auto array = boost::make_shared<visualization_msgs::MarkerArray>();
  array->markers.push_back(ellipsoid(result, odom_frame));
  for (int k = 0; k < 6; ++k) array->markers.push_back(bar(result, odom_frame, k));
  return array;
}

}  // namespace allan_lio
