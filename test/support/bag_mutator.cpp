// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_mutator.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <fstream>
#include <iterator>

namespace allan_lio {
namespace {

std::vector<BagItem> apply(const std::vector<Mutation>& mutations, const BagItem& item, double t) {
  std::vector<BagItem> items{item};
  for (const Mutation& mutation : mutations) {
    std::vector<BagItem> changed;
    for (const BagItem& one : items)
      for (BagItem& made : mutation(one, t)) changed.push_back(std::move(made));
    items = std::move(changed);
  }
  return items;
}

}  // namespace

void mutate_bag(const std::string& from, const std::string& to, const std::vector<Mutation>& mutations) {
  rosbag::Bag in(from, rosbag::bagmode::Read), out(to, rosbag::bagmode::Write);
  rosbag::View view(in);
  const ros::Time begin = view.getBeginTime();
  for (const rosbag::MessageInstance& message : view) {
    const BagItem item{message.getTime(), message.getTopic(), message.instantiate<sensor_msgs::Imu>(),
                       message.instantiate<sensor_msgs::PointCloud2>()};
    if (!item.imu && !item.cloud) continue;
    for (const BagItem& made : apply(mutations, item, (item.time - begin).toSec())) {
      if (made.imu) out.write(made.topic, made.time, *made.imu);
      if (made.cloud) out.write(made.topic, made.time, *made.cloud);
    }
  }
  out.close();
}

void cut_file(const std::string& from, const std::string& to, double part) {
  std::ifstream in(from, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const double kept = part * static_cast<double>(bytes.size());
  std::ofstream(to, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(kept));
}

}  // namespace allan_lio
