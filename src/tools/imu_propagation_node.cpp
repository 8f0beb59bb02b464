// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ros/ros.h>

#include "allan_lio/ros/imu_propagator.h"
#include "allan_lio/ros/shut_down_on_sigterm.h"
#include "allan_lio/ros/stopped_at_start.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "imu_propagation");
  // Outside of the try block: when the last handle goes, so does the console.
  const ros::NodeHandle handle, private_handle("~");
  allan_lio::shut_down_on_sigterm();
  try {
    allan_lio::ImuPropagator wrapped(handle, private_handle);
    ros::spin();
  } catch (const allan_lio::StoppedAtStart&) {
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  return 0;
}
