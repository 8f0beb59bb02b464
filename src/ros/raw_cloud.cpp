// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/raw_cloud.h"

#include <sensor_msgs/PointCloud2.h>

#include <algorithm>

#include "allan_lio/ros/cloud_layout.h"
#include "allan_lio/ros/livox_custom.h"

namespace allan_lio {
namespace {

// In the header: sequence number, stamp, length of the frame_id, frame_id [bytes].
constexpr std::size_t kStampAt = 4, kStampEnd = 12, kFrameAt = 16;

}  // namespace

const std::vector<std::string>& cloud_datatypes() {
  static const std::vector<std::string> kNames{ros::message_traits::datatype<sensor_msgs::PointCloud2>(),
                                               "livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"};
  return kNames;
}

std::optional<CloudKind> cloud_kind(const RawCloud& cloud, std::string& error) {
  error.clear();
  const std::vector<std::string>& names = cloud_datatypes();
  const auto found = std::find(names.begin(), names.end(), cloud.datatype);
  if (found == names.end()) {
    error = "the LiDAR's topic is of type " + cloud.datatype + "; " + names[0] + ", " + names[1] + " and " + names[2] +
            " are read";
    return std::nullopt;
  }
  const bool livox = found != names.begin();
  const std::string md5sum = livox ? kLivoxCustomMd5sum : ros::message_traits::md5sum<sensor_msgs::PointCloud2>();
  if (cloud.md5sum == md5sum) return livox ? CloudKind::kLivoxCustom : CloudKind::kPointCloud2;
  error = "the LiDAR's topic is of another version of " + cloud.datatype + ": its md5sum is " + cloud.md5sum +
          ", that of the one that is read " + md5sum;
  return std::nullopt;
}

std::optional<std::uint32_t> number_of(const RawCloud& cloud) {
  if (cloud.size < kStampAt) return std::nullopt;
  return load<std::uint32_t>(cloud.bytes);
}

std::optional<TimeNs> stamp_of(const RawCloud& cloud) {
  if (cloud.size < kStampEnd) return std::nullopt;
  return TimeNs{load<std::uint32_t>(cloud.bytes + kStampAt)} * kNsPerSecond +
         load<std::uint32_t>(cloud.bytes + kStampAt + sizeof(std::uint32_t));
}

std::string frame_of(const RawCloud& cloud) {
  if (cloud.size < kFrameAt) return "";
  const std::size_t length = load<std::uint32_t>(cloud.bytes + kStampEnd);
  if (length > cloud.size - kFrameAt) return "";
  return std::string(reinterpret_cast<const char*>(cloud.bytes + kFrameAt), length);
}

RawCloud to_raw_cloud(const BagMessage& message) {
  return {message.connection->datatype, message.connection->md5sum, message.bytes.data(), message.bytes.size()};
}

RawCloud to_raw_cloud(const topic_tools::ShapeShifter& message, std::vector<std::uint8_t>& storage) {
  storage.resize(message.size());
  ros::serialization::OStream stream(storage.data(), static_cast<std::uint32_t>(storage.size()));
  message.write(stream);
  return {message.getDataType(), message.getMD5Sum(), storage.data(), storage.size()};
}

}  // namespace allan_lio
