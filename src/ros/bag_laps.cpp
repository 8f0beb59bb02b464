// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_laps.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

/// In std_msgs/Header as it is serialised: after the sequence number.
constexpr std::size_t kStampOffset = 4;

/// Whether the first field that a message's definition declares is a header.
bool begins_with_header(const std::string& definition) {
  std::istringstream lines(definition);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type;
    if (words >> type) return type == "Header" || type == "std_msgs/Header";
  }
  return false;
}

ros::Time read_stamp(const std::vector<std::uint8_t>& bytes) {
  ros::Time stamp;
  std::memcpy(&stamp.sec, bytes.data() + kStampOffset, sizeof stamp.sec);
  std::memcpy(&stamp.nsec, bytes.data() + kStampOffset + sizeof stamp.sec, sizeof stamp.nsec);
  return stamp;
}

void write_stamp(const ros::Time& stamp, std::vector<std::uint8_t>& bytes) {
  std::memcpy(bytes.data() + kStampOffset, &stamp.sec, sizeof stamp.sec);
  std::memcpy(bytes.data() + kStampOffset + sizeof stamp.sec, &stamp.nsec, sizeof stamp.nsec);
}

}  // namespace

BagLaps::BagLaps(const std::vector<std::string>& files, std::uint64_t laps)
    : files_(files), bags_(std::make_unique<BagSource>(files)), laps_(laps) {}

bool BagLaps::has_header(const BagConnection& connection) {
  const auto known = headers_.find(connection.datatype);
  if (known != headers_.end()) return known->second;
  return headers_[connection.datatype] = begins_with_header(connection.definition);
}

void BagLaps::measure(const BagMessage& message) {
  if (!same_topic(message.connection->topic, measured_)) return;
  last_ = read_stamp(message.bytes);
  if (count_++ == 0) first_ = last_;
}

void BagLaps::begin_lap() {
  if (lap_ == 0) {
    if (count_ < 2 || last_ <= first_)
      throw BagError("the stamps of " + measured_ + " do not tell how long a lap is: there is no second one");
    const double share = static_cast<double>(count_) / static_cast<double>(count_ - 1);
    period_ = std::llround(static_cast<double>(to_time_ns(last_) - to_time_ns(first_)) * share);
    if (period_ > std::numeric_limits<TimeNs>::max() / 2 / static_cast<TimeNs>(std::max<std::uint64_t>(laps_, 1)))
      throw BagError("the stamps of " + measured_ + " are too far apart for a lap's");
  }
  ++lap_;
  bags_ = std::make_unique<BagSource>(files_);
}

void BagLaps::shift(BagMessage& message) {
  const TimeNs late = period_ * static_cast<TimeNs>(lap_);
  message.time = to_ros_time(to_time_ns(message.time) + late);
  if (message.bytes.size() < kStampOffset + 8 || !has_header(*message.connection)) return;
  write_stamp(to_ros_time(to_time_ns(read_stamp(message.bytes)) + late), message.bytes);
}

bool BagLaps::next(BagMessage& message) {
  while (!bags_->next(message)) {
    if (lap_ + 1 >= laps_ || !bags_->troubles().empty()) return false;
    begin_lap();
  }
  const bool whole = message.bytes.size() >= kStampOffset + 8;
  if (lap_ == 0 && whole && has_header(*message.connection)) measure(message);
  if (lap_ > 0) shift(message);
  return true;
}

}  // namespace allan_lio
