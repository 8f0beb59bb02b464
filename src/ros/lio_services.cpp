// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_services.h"

#include <ros/console.h>

#include <filesystem>
#include <utility>

#include "allan_lio/ros/pose_request.h"
#include "allan_lio/ros/save_map.h"

namespace allan_lio {
namespace {

/// Answers, and says the same in the log.
template <class Response>
bool answer(Response& response, bool success, const std::string& message) {
  response.success = success;
  response.message = message;
  if (success) {
    ROS_INFO_STREAM(message);
  } else {
    ROS_ERROR_STREAM(message);
  }
  return true;
}

}  // namespace

LioServices::LioServices(ros::NodeHandle private_handle, Context context)
    : context_(std::move(context)),
      save_map_(private_handle.advertiseService("save_map", &LioServices::on_save_map, this)),
      reset_(private_handle.advertiseService("reset", &LioServices::on_reset, this)),
      set_pose_(private_handle.advertiseService("set_pose", &LioServices::on_set_pose, this)) {}

bool LioServices::on_save_map(SaveMap::Request& request, SaveMap::Response& response) {
  const std::filesystem::path name = request.path.empty() ? "map.pcd" : request.path;
  try {
    const std::string path = std::filesystem::absolute(std::filesystem::path(context_.out) / name).string();
    const std::vector<WorldPoint> points = context_.session.odometry().map_points();
    save_map(path, points);
    return answer(response, true, path + ": " + std::to_string(points.size()) + " points");
  } catch (const std::exception& error) {
    return answer(response, false, error.what());
  }
}

bool LioServices::on_reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  if (context_.session.finished()) return answer(response, false, "the run has ended");
  context_.session.reset();
  context_.on_reset();
  return answer(response, true, "the estimator starts again with the data to come, at the origin and with a new map");
}

bool LioServices::on_set_pose(SetPose::Request& request, SetPose::Response& response) {
  if (context_.session.finished()) return answer(response, false, "the run has ended");
  try {
    const std::string& frame = context_.session.odometry().config().frames.odom;
    const auto attitude = context_.attitude();
    context_.session.set_pose(to_anchor(request.pose, frame, context_.T_base_imu, attitude));
    return answer(response, true,
                  attitude ? "pose set, the map starts anew there" : "pose set: there the run will begin");
  } catch (const std::exception& error) {
    return answer(response, false, std::string("set_pose: ") + error.what());
  }
}

}  // namespace allan_lio
