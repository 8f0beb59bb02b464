// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/SaveMap.h>
#include <allan_lio/SetPose.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <optional>
#include <string>

#include "allan_lio/ros/lio_session.h"

namespace allan_lio {

/// ~save_map, ~reset and ~set_pose. Their callbacks must not run at the same time as the session's.
class LioServices {
 public:
  struct Context {
    LioSession& session;
    RigidTransform T_base_imu;
    std::string out;                                              ///< where a map goes; empty: the working directory
    std::function<std::optional<Eigen::Quaterniond>()> attitude;  ///< R_world_imu, if there is an estimate yet
    std::function<void()> on_reset;                               ///< the estimator has started again
  };
  LioServices(ros::NodeHandle private_handle, Context context);

 private:
  bool on_save_map(SaveMap::Request& request, SaveMap::Response& response);
  bool on_reset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool on_set_pose(SetPose::Request& request, SetPose::Response& response);

  Context context_;
  ros::ServiceServer save_map_, reset_, set_pose_;
};

}  // namespace allan_lio
