// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/cloud_wire.h"

#include <cstring>

namespace allan_lio {
namespace {

/// Goes over a message as ROS serialises it: little-endian, a count of 32 bits before strings and lists.
class WireWalk {
 public:
  WireWalk(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}

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
  bool ok() const { return ok_; }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
  bool ok_ = true;
};

}  // namespace

bool holds_point_cloud(const std::uint8_t* bytes, std::size_t size) {
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
  walk.skip_string();    // data
  walk.skip(1);          // is_dense
  return walk.ok();
}

}  // namespace allan_lio
