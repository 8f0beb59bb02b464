// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The faults that fault_by_name() knows.
#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include "bag_mutator.h"

namespace allan_lio {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

bool inside(double t, double from, double to) { return from <= t && t < to; }

/// A copy that shares nothing with the original.
BagItem later(BagItem item, double seconds) {
  item.time += ros::Duration(seconds);
  if (item.imu) item.imu = boost::make_shared<sensor_msgs::Imu>(*item.imu);
  if (item.cloud) item.cloud = boost::make_shared<sensor_msgs::PointCloud2>(*item.cloud);
  return item;
}

/// Every `period`-th IMU message through `change`.
Mutation every_imu(int period, const std::function<void(sensor_msgs::Imu&, int)>& change) {
  return [period, change, count = 0](BagItem item, double) mutable {
    if (item.imu && ++count % period == 0) change(*item.imu, count / period);
    return std::vector<BagItem>{std::move(item)};
  };
}

/// Every `period`-th cloud through `change`.
Mutation every_cloud(int period, const std::function<void(sensor_msgs::PointCloud2&, int)>& change) {
  return [period, change, count = 0](BagItem item, double) mutable {
    if (item.cloud && ++count % period == 0) change(*item.cloud, count / period);
    return std::vector<BagItem>{std::move(item)};
  };
}

/// No IMU, or no scans, between the two times [s].
Mutation imu_gap(double from, double to) {
  return [=](BagItem item, double t) {
    return item.imu && inside(t, from, to) ? std::vector<BagItem>{} : std::vector<BagItem>{std::move(item)};
  };
}
Mutation lidar_gap(double from, double to) {
  return [=](BagItem item, double t) {
    return item.cloud && inside(t, from, to) ? std::vector<BagItem>{} : std::vector<BagItem>{std::move(item)};
  };
}

/// Every `period`-th message of one kind comes again `delay` [s] later, its stamp set back by `back` [s].
template <class Message>
Mutation again(boost::shared_ptr<Message> BagItem::*kind, int period, double delay, double back) {
  return [=, count = 0](BagItem item, double) mutable {
    std::vector<BagItem> items{item};
    if (item.*kind && ++count % period == 0) {
      BagItem copy = later(item, delay);
      (copy.*kind)->header.stamp -= ros::Duration(back);
      items.push_back(std::move(copy));
    }
    return items;
  };
}

void keep_points(sensor_msgs::PointCloud2& cloud, std::uint32_t points) {
  cloud.height = 1;
  cloud.width = points;
  cloud.row_step = points * cloud.point_step;
  cloud.data.resize(cloud.row_step);
}

void set_position(sensor_msgs::PointCloud2& cloud, std::size_t point, float x, float y, float z) {
  const float position[3] = {x, y, z};
  std::memcpy(&cloud.data[point * cloud.point_step], position, sizeof position);
}

/// Of every ten points one each that is NaN, inf, zero, nearer and farther than the limits.
void spoil_points(sensor_msgs::PointCloud2& cloud, int) {
  for (std::size_t i = 0; i + 10 <= cloud.width; i += 10) {
    set_position(cloud, i, std::nanf(""), 1, 1);
    set_position(cloud, i + 1, 1, std::numeric_limits<float>::infinity(), 1);
    set_position(cloud, i + 2, 0, 0, 0);
    set_position(cloud, i + 3, 0.1F, 0, 0);
    set_position(cloud, i + 4, 0, 1e6F, 0);
  }
}

void senseless(sensor_msgs::Imu& imu, int count) {
  double* const values[6] = {&imu.angular_velocity.x,    &imu.angular_velocity.y,    &imu.angular_velocity.z,
                             &imu.linear_acceleration.x, &imu.linear_acceleration.y, &imu.linear_acceleration.z};
  constexpr double kSenseless[4] = {kNaN, kInf, -1e4, 1e300};
  *values[count % 6] = kSenseless[count % 4];
}

/// As a sensor would that measures up to kClippedRate [rad/s] only; the rooms' walk turns faster in its corners.
void saturate(sensor_msgs::Imu& imu, int) {
  double& rate = imu.angular_velocity.z;
  rate = std::clamp(rate, -kClippedRate, kClippedRate);
}

/// The same of an accelerometer that measures up to kClippedAccel [m/s^2]; the walk's steps go beyond.
void saturate_accel(sensor_msgs::Imu& imu, int) {
  auto& accel = imu.linear_acceleration;
  for (double* const axis : {&accel.x, &accel.y, &accel.z}) *axis = std::clamp(*axis, -kClippedAccel, kClippedAccel);
}

/// In turn: sizes beyond the data, a field beyond the point, no step, less data than said, steps that overflow.
void lie(sensor_msgs::PointCloud2& cloud, int count) {
  constexpr auto kHuge = std::numeric_limits<std::uint32_t>::max();
  if (count % 5 == 0) cloud.width = kHuge;
  if (count % 5 == 1) cloud.fields[0].offset = kHuge - 1;
  if (count % 5 == 2) cloud.point_step = 0;
  if (count % 5 == 3) cloud.data.resize(cloud.data.size() / 2);
  if (count % 5 == 4) cloud.height = cloud.width = cloud.row_step = kHuge;
}

void drop_time_field(sensor_msgs::PointCloud2& cloud, int) {
  const auto is_time = [](const sensor_msgs::PointField& field) { return field.name == "time"; };
  cloud.fields.erase(std::remove_if(cloud.fields.begin(), cloud.fields.end(), is_time), cloud.fields.end());
}

/// One message whose stamp lies 1000 s ahead of its time.
Mutation one_imu_from_the_future() {
  return every_imu(1500, [](sensor_msgs::Imu& imu, int count) {
    if (count == 1) imu.header.stamp += ros::Duration(1000.0);
  });
}

Mutation one_cloud_from_the_future() {
  return every_cloud(70, [](sensor_msgs::PointCloud2& cloud, int count) {
    if (count == 1) cloud.header.stamp += ros::Duration(1000.0);
  });
}

/// The whole recording, and again as a player in a loop gives it: with the stamps it had, after its end.
Mutation loop(double length) {
  return [=](BagItem item, double) { return std::vector<BagItem>{item, later(item, length)}; };
}

/// From `t` on all stamps lie `seconds` later: a clock that is set.
Mutation clock_step(double from, double seconds) {
  return [=](BagItem item, double t) {
    if (t >= from && item.imu) item.imu->header.stamp += ros::Duration(seconds);
    if (t >= from && item.cloud) item.cloud->header.stamp += ros::Duration(seconds);
    return std::vector<BagItem>{std::move(item)};
  };
}

void lidar_clock_off(sensor_msgs::PointCloud2& cloud, int) { cloud.header.stamp -= ros::Duration(1.6e9); }

const std::map<std::string, std::function<Mutation()>>& faults() {
  static const std::map<std::string, std::function<Mutation()>> known{
      {"points_invalid", [] { return every_cloud(1, spoil_points); }},
      {"scans_empty", [] { return every_cloud(40, [](auto& cloud, int) { keep_points(cloud, 0); }); }},
      {"scans_thin", [] { return every_cloud(50, [](auto& cloud, int) { keep_points(cloud, 30); }); }},
      {"scans_lie", [] { return every_cloud(20, lie); }},
      {"no_time_field", [] { return every_cloud(1, drop_time_field); }},
      {"imu_repeated", [] { return again(&BagItem::imu, 100, 0.0, 0.0); }},
      {"imu_backward", [] { return again(&BagItem::imu, 150, 0.001, 0.05); }},
      {"imu_from_the_future", [] { return one_imu_from_the_future(); }},
      {"lidar_from_the_future", [] { return one_cloud_from_the_future(); }},
      {"lidar_repeated", [] { return again(&BagItem::cloud, 30, 0.01, 0.0); }},
      {"lidar_backward", [] { return again(&BagItem::cloud, 35, 0.02, 0.15); }},
      {"imu_gap_short", [] { return imu_gap(8.0, 8.08); }},
      {"imu_gap_bridged", [] { return imu_gap(8.0, 8.6); }},
      {"imu_gap_long", [] { return imu_gap(8.0, 11.0); }},
      {"lidar_gap", [] { return lidar_gap(8.0, 10.0); }},
      {"lidar_gap_long", [] { return lidar_gap(8.0, 11.0); }},
      {"looped", [] { return loop(21.0); }},
      {"clock_set_forward", [] { return clock_step(10.0, 3600.0); }},
      {"imu_saturated", [] { return every_imu(1, saturate); }},
      {"imu_saturated_accel", [] { return every_imu(1, saturate_accel); }},
      {"imu_senseless", [] { return every_imu(90, senseless); }},
      {"lidar_clock_off", [] { return every_cloud(1, lidar_clock_off); }},
  };
  return known;
}

}  // namespace

Mutation fault_by_name(const std::string& name) {
  const auto found = faults().find(name);
  if (found != faults().end()) return found->second();
  std::string names;
  for (const auto& fault : faults()) names += (names.empty() ? "" : ", ") + fault.first;
  throw std::invalid_argument("no fault '" + name + "'; there are " + names);
}

}  // namespace allan_lio
