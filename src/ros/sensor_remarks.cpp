// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/sensor_remarks.h"

#include <cstdio>
#include <utility>

namespace allan_lio {

void SensorRemarks::look(const std::string& frame, const char* sensor, Frames& frames) {
  if (!frames.first) frames.first = frame;
  if (frame == *frames.first && !frame.empty()) return;
  if (std::exchange(frame.empty() ? frames.told_empty : frames.told_change, true)) return;
  const std::string messages = "the " + std::string(sensor) + "'s messages";
  if (frame.empty())
    sentences_.push_back(messages + " have an empty frame_id; they are taken as the sensor's all the same");
  else
    sentences_.push_back(messages + " change their frame_id from '" + *frames.first + "' to '" + frame +
                         "'; they are taken as the same sensor's all the same");
}

void SensorRemarks::accel_scale(double scale) {
  if (std::exchange(told_accel_, true)) return;
  char text[96] = "accelerometer: reads in m/s^2";
  if (scale != 1.0) std::snprintf(text, sizeof text, "accelerometer: reads in g, taken times %.6g m/s^2", scale);
  sentences_.push_back(text);
}

}  // namespace allan_lio
