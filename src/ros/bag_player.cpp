// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_player.h"

#include <ros/names.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/Imu.h>
#include <topic_tools/shape_shifter.h>

#include <cmath>
#include <stdexcept>

#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/raw_cloud.h"

namespace allan_lio {
namespace {

constexpr std::uint64_t kScansUnderWay = 4;   // the filter's queue holds 20
constexpr std::uint64_t kImuUnderWay = 1500;  // the filter's queue holds 4000
constexpr double kClockStep = 0.005;          // [s]
constexpr double kLongestGap = 3600.0;        // that is waited for: beyond, a clock was wild or it is another day [s]
constexpr int kOtherQueue = 100;
constexpr double kPoll = 0.001;  // [s]

/// Topics that a player must not repeat: they belong to the machine that plays.
bool is_ours(const std::string& topic) {
  return same_topic(topic, "clock") || same_topic(topic, "rosout") || same_topic(topic, "rosout_agg");
}

void nap() {
  ros::spinOnce();
  ros::WallDuration(kPoll).sleep();
}

}  // namespace

BagPlayer::BagPlayer(const std::vector<std::string>& bags, const Options& options)
    : laps_(bags, options.laps),
      files_(bags),
      filter_(ros::names::resolve(options.filter)),
      rate_(options.rate),
      patience_(options.patience) {
  clock_ = handle_.advertise<rosgraph_msgs::Clock>("/clock", 10);
  wait_for_filter(patience_);
  laps_.bags().require(answer_.imu_topic, {ros::message_traits::datatype<sensor_msgs::Imu>()});
  laps_.bags().require(answer_.lidar_topic, cloud_datatypes());
  laps_.measure_by(answer_.imu_topic);
}

void BagPlayer::wait_for_filter(double patience) {
  const std::string name = filter_ + "/finish";
  const ros::WallTime until = ros::WallTime::now() + ros::WallDuration(patience);
  while (!ros::service::exists(name, false)) {
    if (!ros::ok()) throw std::runtime_error("interrupted");
    if (ros::WallTime::now() > until) throw std::runtime_error("no answer from " + name + ": the filter does not run");
    ros::WallDuration(0.05).sleep();
  }
  constexpr bool kPersistent = true;  // a connection that stays makes the questions cheap
  service_ = handle_.serviceClient<Finish>(name, kPersistent);
  ask(false);
}

Finish::Response BagPlayer::ask(bool end) {
  Finish call;
  call.request.imu_sent = imu_sent_;
  call.request.scans_sent = scans_sent_;
  call.request.end = end;
  call.request.inputs = files_;
  if (end) call.request.notes = laps_.bags().troubles();
  if (!service_.call(call)) {
    if (ros::ok()) throw std::runtime_error("the filter " + filter_ + " has gone");
    return answer_;
  }
  answer_ = call.response;
  return answer_;
}

bool BagPlayer::filter_subscribes(const std::string& topic) { return subscribers_[topic].count(answer_.node) > 0; }

void BagPlayer::advertise(const BagConnection& connection) {
  const std::string topic = ros::names::resolve(connection.topic);
  const bool watched = same_topic(topic, answer_.imu_topic) || same_topic(topic, answer_.lidar_topic);
  // Queues without bound where the filter's answers bound what is under way.
  ros::AdvertiseOptions options(topic, watched ? 0 : kOtherQueue, connection.md5sum, connection.datatype,
                                connection.definition, [this, topic](const ros::SingleSubscriberPublisher& link) {
                                  subscribers_[topic].insert(link.getSubscriberName());
                                });
  options.latch = connection.latching;
  publishers_[connection.topic] = handle_.advertise(options);
}

void BagPlayer::wait_for_subscriptions(double patience) {
  const ros::WallTime until = ros::WallTime::now() + ros::WallDuration(patience);
  while (!filter_subscribes(answer_.imu_topic) || !filter_subscribes(answer_.lidar_topic)) {
    if (!ros::ok()) return;
    if (ros::WallTime::now() > until)
      throw std::runtime_error("the filter " + filter_ + " did not subscribe to " + answer_.imu_topic + " and " +
                               answer_.lidar_topic);
    nap();
  }
}

void BagPlayer::pace(const ros::Time& time) {
  if (begin_.isZero() || std::abs(seconds_between(last_, time)) > kLongestGap) {
    begin_ = time;
    wall_begin_ = ros::WallTime::now();
  }
  last_ = time;
  if (rate_ > 0.0) {
    const ros::WallTime due = wall_begin_ + ros::WallDuration(seconds_between(begin_, time) / rate_);
    while (ros::ok() && ros::WallTime::now() < due) nap();
  }
  if (!last_clock_.isZero() && seconds_between(last_clock_, time) < kClockStep) return;
  last_clock_ = time;
  rosgraph_msgs::Clock clock;
  clock.clock = time;
  clock_.publish(clock);
}

void BagPlayer::publish(const BagMessage& message) {
  const BagConnection& connection = *message.connection;
  topic_tools::ShapeShifter shifter;
  shifter.morph(connection.md5sum, connection.datatype, connection.definition, connection.latching ? "1" : "0");
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(message.bytes.data()),
                                     static_cast<std::uint32_t>(message.bytes.size()));
  shifter.read(stream);
  publishers_[connection.topic].publish(shifter);
  if (same_topic(connection.topic, answer_.imu_topic)) ++imu_sent_;
  if (same_topic(connection.topic, answer_.lidar_topic)) ++scans_sent_;
}

void BagPlayer::hold() {
  const auto full = [this] {
    return scans_sent_ >= answer_.scans_received + kScansUnderWay || imu_sent_ >= answer_.imu_received + kImuUnderWay;
  };
  if (!full()) return;
  ros::WallTime until = ros::WallTime::now() + ros::WallDuration(patience_);
  while (ros::ok()) {
    const Finish::Response before = answer_;
    ask(false);
    if (!full() || !answer_.message.empty()) return;
    const bool moved = answer_.scans_received > before.scans_received || answer_.imu_received > before.imu_received;
    if (moved) until = ros::WallTime::now() + ros::WallDuration(patience_);
    if (ros::WallTime::now() > until) throw std::runtime_error("the filter " + filter_ + " takes no more data");
    nap();
  }
}

void BagPlayer::finish() {
  ros::WallTime until = ros::WallTime::now() + ros::WallDuration(patience_);
  while (ros::ok()) {
    const Finish::Response before = answer_;
    ask(true);
    if (answer_.finished) break;
    if (answer_.scans_received > before.scans_received || answer_.imu_received > before.imu_received)
      until = ros::WallTime::now() + ros::WallDuration(patience_);
    if (ros::WallTime::now() > until)
      throw std::runtime_error("of " + std::to_string(scans_sent_) + " scans and " + std::to_string(imu_sent_) +
                               " IMU samples " + std::to_string(answer_.scans_received) + " and " +
                               std::to_string(answer_.imu_received) + " reached the filter");
    nap();
  }
  if (!answer_.success && answer_.finished) throw std::runtime_error(answer_.message);
  const std::vector<std::string> troubles = laps_.bags().troubles();
  if (!troubles.empty()) throw std::runtime_error(troubles.front());
}

void BagPlayer::play() {
  // Every publisher must be there before the first message, so that subscribers can connect.
  for (const auto& connection : laps_.bags().connections()) {
    if (is_ours(connection->topic) || publishers_.count(connection->topic) > 0) continue;
    advertise(*connection);
  }
  wait_for_subscriptions(patience_);
  BagMessage message;
  // A message of the filter's before the end: it is of no use to go on.
  while (ros::ok() && answer_.message.empty() && laps_.next(message)) {
    if (is_ours(message.connection->topic)) continue;
    pace(message.time);
    publish(message);
    hold();
    ros::spinOnce();
  }
  if (ros::ok()) finish();
}

}  // namespace allan_lio
