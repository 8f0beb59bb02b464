// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "lidar_model.h"

#include <sensor_msgs/PointCloud2.h>

#include <algorithm>
#include <optional>

#include "allan_lio/ros/cloud_layout.h"
#include "allan_lio/ros/cloud_wire.h"
#include "allan_lio/ros/raw_cloud.h"

namespace allan_lio {
namespace {

bool contains(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

bool has(const sensor_msgs::PointCloud2& cloud, const char* name) {
  return std::any_of(cloud.fields.begin(), cloud.fields.end(), [&](const auto& field) { return field.name == name; });
}

/// How many beams a Velodyne has, by the largest ring.
double largest_ring(const CloudView& cloud) {
  // The ring is read as if it were the time: any field of the layout will do.
  std::string error;
  const std::optional<CloudLayout> layout = read_layout(cloud, "ring", error);
  double largest = 0.0;
  if (!layout || !layout->time) return largest;
  for (std::size_t row = 0; row < layout->rows; ++row)
    for (std::size_t column = 0; column < layout->columns; ++column)
      largest = std::max(largest, load_number(layout->data + row * layout->row_step + column * layout->point_step +
                                                  layout->time->offset,
                                              layout->time->type));
  return largest;
}

}  // namespace

std::string guess_lidar_model(const BagMessage& message) {
  const RawCloud raw = to_raw_cloud(message);
  std::string error;
  if (cloud_kind(raw, error) == CloudKind::kLivoxCustom) return "lidar/livox";
  const auto cloud = error.empty() ? read_point_cloud(raw.bytes, raw.size) : std::nullopt;
  if (!cloud) return "lidar/velodyne16";
  const sensor_msgs::PointCloud2& head = cloud->head;
  const std::string names = message.connection->topic + " " + head.header.frame_id;
  if (has(head, "tag") && has(head, "line")) return "lidar/livox";
  if (has(head, "t")) return "lidar/ouster";
  if (has(head, "timestamp")) return contains(names, "rslidar") ? "lidar/robosense" : "lidar/hesai";
  const double ring = largest_ring(*cloud);
  return ring < 16 ? "lidar/velodyne16" : ring < 32 ? "lidar/velodyne32" : "lidar/velodyne64";
}

}  // namespace allan_lio
