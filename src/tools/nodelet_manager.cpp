// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// nodelet's manager, but SIGINT and SIGTERM end it in order, with status 0, whenever they come.
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/ros.h>

#include "allan_lio/ros/stop_signals.h"

namespace {

const ros::WallDuration kLook(0.1);  // for a signal

}  // namespace

int main(int argc, char** argv) {
  const allan_lio::StopSignals stop;
  ros::init(argc, argv, "nodelet_manager", ros::init_options::NoSigintHandler);
  while (!ros::master::check()) {  // the first call to one that is not there would wait for it, whatever the signals
    if (stop.flag()) return 0;
    ROS_WARN_ONCE("waits for a master at %s", ros::master::getURI().c_str());
    kLook.sleep();
  }
  nodelet::Loader manager;
  // ros::spin() has ROS shut down by another thread: a nodelet that is being loaded then gets no topics and no bond to
  // its loader, and whoever publishes on these ends the process.
  while (ros::ok() && !stop.flag()) ros::getGlobalCallbackQueue()->callAvailable(kLook);
  // nodelet's own leaves this to ~Loader, which, with a bond still open, looks a nodelet up in a map that is gone.
  manager.clear();
  ros::shutdown();
  return 0;
}
