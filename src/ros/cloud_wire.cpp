// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/cloud_wire.h"

#include <cstring>

namespace allan_lio {
namespace {

/// Goes over a message as ROS serialises it: little-endian, a count of 32 bits before strings and lists.
class WireWalk {
 public:
  WireWalk(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes), at_(bytes), left_(size) {}

  void skip(std::uint64_t bytes) {
    ok_ = ok_ && bytes <= left_;
    if (!ok_) return;
    at_ += bytes;
    left_ -= static_cast<std::size_t>(bytes);
  }
  std::uint32_t count() {
    const std::uint8_t* const from = at_;
    skip(sizeof(std::uint32_t));
    std::uint32_t value = 0;
    if (ok_) std::memcpy(&value, from, sizeof value);
    return value;
  }
  void skip_string() { skip(count()); }
  /// From the start to here.
  std::size_t size() const { return static_cast<std::size_t>(at_ - bytes_); }
  bool ok() const { return ok_; }

 private:
  const std::uint8_t* bytes_;
  const std::uint8_t* at_;
  std::size_t left_;
  bool ok_ = true;
};

}  // namespace

std::optional<CloudView> read_point_cloud(const std::uint8_t* bytes, std::size_t size) {
  WireWalk walk(bytes, size);
  walk.skip(4 + 8);    // header: seq, stamp
  walk.skip_string();  // frame_id
  walk.skip(4 + 4);    // height, width
  const std::uint32_t fields = walk.count();
  // A field takes 13 bytes at least, so a count that lies ends this soon.
  for (std::uint32_t i = 0; i < fields && walk.ok(); ++i) {
    walk.skip_string();    // name
    walk.skip(4 + 1 + 4);  // offset, datatype, count
  }
  walk.skip(1 + 4 + 4);  // is_bigendian, point_step, row_step
  const std::size_t head_size = walk.size();
  CloudView out;
  out.size = walk.count();
  out.data = bytes + walk.size();
  walk.skip(out.size);
  walk.skip(1);  // is_dense
  if (!walk.ok()) return std::nullopt;

  // IStream takes a pointer to non-const although it only reads.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(bytes), static_cast<std::uint32_t>(head_size));
  sensor_msgs::PointCloud2& head = out.head;
  stream.next(head.header);
  stream.next(head.height);
  stream.next(head.width);
  stream.next(head.fields);
  stream.next(head.is_bigendian);
  stream.next(head.point_step);
  stream.next(head.row_step);
  head.is_dense = out.data[out.size];
  return out;
}

CloudView view_of(const sensor_msgs::PointCloud2& cloud) {
  CloudView out;
  out.data = cloud.data.data();
  out.size = cloud.data.size();
  sensor_msgs::PointCloud2& head = out.head;
  head.header = cloud.header;
  head.height = cloud.height;
  head.width = cloud.width;
  head.fields = cloud.fields;
  head.is_bigendian = cloud.is_bigendian;
  head.point_step = cloud.point_step;
  head.row_step = cloud.row_step;
  head.is_dense = cloud.is_dense;
  return out;
}

}  // namespace allan_lio
