// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "allan_lio/ros/lio_wrapper.h"
#include "allan_lio/ros/shut_down_on_sigterm.h"
#include "allan_lio/ros/stopped_at_start.h"

namespace allan_lio {

class LidarOdometryNodelet : public nodelet::Nodelet {
  void onInit() override {
    shut_down_on_sigterm();  // of the manager, which would not unload its nodelets
    try {
      wrapped_ = std::make_unique<LioWrapper>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const StoppedAtStart&) {
      throw;
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());
      throw;  // the manager then unloads this nodelet, and its loader exits non-zero
    }
  }

  std::unique_ptr<LioWrapper> wrapped_;
};

}  // namespace allan_lio

PLUGINLIB_EXPORT_CLASS(allan_lio::LidarOdometryNodelet, nodelet::Nodelet)
