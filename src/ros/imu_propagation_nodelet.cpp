// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "allan_lio/ros/imu_propagator.h"
#include "allan_lio/ros/stopped_at_start.h"

namespace allan_lio {

class ImuPropagationNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      wrapped_ = std::make_unique<ImuPropagator>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const StoppedAtStart&) {
      throw;
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());
      throw;  // the manager then unloads this nodelet, and its loader exits non-zero
    }
  }

  std::unique_ptr<ImuPropagator> wrapped_;
};

}  // namespace allan_lio

PLUGINLIB_EXPORT_CLASS(allan_lio::ImuPropagationNodelet, nodelet::Nodelet)
