// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Plays a bag's sensors in real time, as their drivers would, and measures how long after an IMU message its odometry
// comes back.
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <vector>

#include "allan_lio/ros/bag_source.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/thread_priority.h"

namespace {

using allan_lio::BagMessage;

constexpr double kConnect = 30.0;   // [s] until both nodelets listen
constexpr double kTail = 0.5;       // [s] to wait for the last answers
constexpr int kPriority = 2;        // real-time, of what times
constexpr double kEnough = 0.999;   // of the messages within the limit
constexpr double kHeadStart = 1.0;  // [s] between the agreement to begin and the first message

/// When each IMU message went out, and how long after it the odometry of its stamp came in. Safe to call from threads.
class Stopwatch {
 public:
  void sent(const ros::Time& stamp) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sent_[stamp] = ros::WallTime::now();
  }

  void received(const ros::Time& stamp) {
    const ros::WallTime now = ros::WallTime::now();
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = sent_.find(stamp);
    if (found == sent_.end()) return;
    if (delays_.empty()) first_ = stamp;
    delays_.push_back((now - found->second).toSec());
  }

  /// Delays of the messages from the first answered one on; infinite where no answer came.
  std::vector<double> delays() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<double> all = delays_;
    if (delays_.empty()) return all;
    const auto expected = static_cast<std::size_t>(std::distance(sent_.lower_bound(first_), sent_.end()));
    if (expected > all.size()) all.resize(expected, INFINITY);
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  mutable std::mutex mutex_;
  std::map<ros::Time, ros::WallTime> sent_;
  std::vector<double> delays_;
  ros::Time first_;
};

template <class Message>
ros::Publisher listened_to(ros::NodeHandle& handle, const std::string& topic) {
  const ros::Publisher publisher = handle.advertise<Message>(topic, 4000);
  const ros::WallTime until = ros::WallTime::now() + ros::WallDuration(kConnect);
  while (ros::ok() && ros::WallTime::now() < until) {
    if (publisher.getNumSubscribers() > 0) return publisher;
    ros::WallDuration(0.02).sleep();
  }
  throw std::runtime_error("nobody listens to " + topic);
}

/// Publishes the messages of a topic when they are due, counted from `begin`.
template <class Message>
void play(const std::string& file, const std::string& topic, const ros::Publisher& publisher, double begin,
          const std::function<void(const Message&)>& on_send) {
  allan_lio::BagSource bag({file});
  bag.require(topic, {ros::message_traits::datatype<Message>()});
  bag.select({topic});
  const ros::Time first = bag.begin();
  for (BagMessage recorded; ros::ok() && bag.next(recorded);) {
    const auto message = recorded.as<Message>();
    ros::WallTime::sleepUntil(ros::WallTime(begin + allan_lio::seconds_between(first, recorded.time)));
    on_send(*message);
    publisher.publish(message);
  }
}

struct Options {
  std::string bag, imu_topic = "/imu/data", lidar_topic = "/points", odometry_topic = "/imu_odometry";
  double limit = 0.002;  ///< [s]
};

/// The LiDAR's driver: a process of its own, as on a robot. Tells through `pipe` when it begins.
void be_the_lidar(const Options& options, int pipe) {
  int no_arguments = 0;
  ros::init(no_arguments, nullptr, "imu_latency_lidar");
  ros::NodeHandle handle;
  const ros::Publisher clouds = listened_to<sensor_msgs::PointCloud2>(handle, options.lidar_topic);
  const double begin = ros::WallTime::now().toSec() + kHeadStart;
  if (write(pipe, &begin, sizeof begin) != sizeof begin) return;
  play<sensor_msgs::PointCloud2>(options.bag, options.lidar_topic, clouds, begin,
                                 [](const sensor_msgs::PointCloud2&) {});
}

/// The IMU's driver, which also takes the answers.
std::vector<double> measure(const Options& options, int pipe) {
  ros::NodeHandle handle;
  Stopwatch watch;
  const auto on_odometry = [&watch](const nav_msgs::OdometryConstPtr& m) { watch.received(m->header.stamp); };
  const ros::Subscriber odometry = handle.subscribe<nav_msgs::Odometry>(
      options.odometry_topic, 4000, on_odometry, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::AsyncSpinner spinner(1);
  spinner.start();
  const ros::Publisher imu = listened_to<sensor_msgs::Imu>(handle, options.imu_topic);
  double begin = 0.0;
  if (read(pipe, &begin, sizeof begin) != sizeof begin) throw std::runtime_error("the clouds cannot be played");
  play<sensor_msgs::Imu>(options.bag, options.imu_topic, imu, begin,
                         [&watch](const sensor_msgs::Imu& m) { watch.sent(m.header.stamp); });
  ros::WallDuration(kTail).sleep();
  return watch.delays();
}

/// 0 if enough of the messages came within the limit.
int report(const std::vector<double>& delays, double limit) {
  if (delays.empty()) {
    std::cerr << "imu_latency: no odometry came\n";
    return 1;
  }
  const auto percentile = [&delays](double share) {
    return 1e3 * delays[static_cast<std::size_t>(share * static_cast<double>(delays.size() - 1))];
  };
  const auto within = std::upper_bound(delays.begin(), delays.end(), limit) - delays.begin();
  const double share = static_cast<double>(within) / static_cast<double>(delays.size());
  std::printf("%zu messages, %.3f %% within %g ms; median %.3f ms, 99 %% %.3f ms, 99.9 %% %.3f ms, longest %.3f ms\n",
              delays.size(), 100.0 * share, 1e3 * limit, percentile(0.5), percentile(0.99), percentile(0.999),
              percentile(1.0));
  if (share >= kEnough) return 0;
  std::fprintf(stderr, "imu_latency: that is less than %g %%\n", 100.0 * kEnough);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Plays a bag's IMU and PointCloud2 topics in real time, as drivers would, and measures how long after each IMU "
      "message the odometry with its stamp comes back. The nodelets must run (lio.launch)."};
  Options options;
  app.add_option("bag", options.bag, "the bag")->required()->check(CLI::ExistingFile);
  app.add_option("--imu-topic", options.imu_topic)->capture_default_str();
  app.add_option("--lidar-topic", options.lidar_topic)->capture_default_str();
  app.add_option("--odometry-topic", options.odometry_topic)->capture_default_str();
  app.add_option("--limit", options.limit, "delay of which the share is told [s]")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) return 1;
  const pid_t lidar = fork();  // before ROS starts its threads
  try {
    close(pipe_ends[lidar == 0 ? 0 : 1]);
    if (lidar == 0) {
      be_the_lidar(options, pipe_ends[1]);
      return 0;
    }
    // What is to be waited for is the nodelet, not the clock that times it.
    const std::string hindered = allan_lio::set_thread_priority(0, kPriority, allan_lio::Heirs::kTheSame);
    if (!hindered.empty()) std::cerr << "imu_latency: timed without real-time priority: " << hindered << '\n';
    ros::init(argc, argv, "imu_latency");
    const std::vector<double> delays = measure(options, pipe_ends[0]);
    waitpid(lidar, nullptr, 0);
    return report(delays, options.limit);
  } catch (const std::exception& error) {
    std::cerr << "imu_latency: " << error.what() << '\n';
    return 1;
  }
}
