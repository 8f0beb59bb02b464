// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/save_map.h"

#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace allan_lio {

void save_map(const std::string& path, const std::vector<WorldPoint>& points) {
  if (points.empty()) throw std::runtime_error(path + " is not written: the map is empty");
  // PCL's own words on a path that cannot be opened name neither the path nor the reason.
  const std::string part = path + ".part";  // takes the file's place when it is whole
  if (!std::ofstream(part, std::ios::binary)) throw std::runtime_error("cannot write " + path);
  pcl::PointCloud<pcl::PointXYZI> cloud;
  cloud.reserve(points.size());
  for (const WorldPoint& p : points) {
    pcl::PointXYZI point;
    point.x = p.x;
    point.y = p.y;
    point.z = p.z;
    point.intensity = p.intensity;
    cloud.push_back(point);
  }
  try {
    const int status = pcl::io::savePCDFileBinaryCompressed(part, cloud);
    if (status != 0) throw std::runtime_error("PCL gives up with status " + std::to_string(status));
    std::filesystem::rename(part, path);
  } catch (const std::exception& error) {
    std::remove(part.c_str());
    throw std::runtime_error("cannot write " + path + ": " + error.what());
  }
}

}  // namespace allan_lio
