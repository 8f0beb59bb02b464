// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Listens to everything that the nodelets publish and keeps an account of it, for scripts/bench --soak.
#include <XmlRpcClient.h>
#include <allan_lio/State.h>
#include <allan_lio/Status.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>
#include <visualization_msgs/MarkerArray.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "allan_lio/ros/finite.h"
#include "allan_lio/ros/imu_answers.h"

namespace {

using allan_lio::all_finite;

/// Clouds hold their numbers as bytes.
bool finite(const sensor_msgs::PointCloud2& cloud) {
  for (const sensor_msgs::PointField& field : cloud.fields) {
    if (field.datatype != sensor_msgs::PointField::FLOAT32) continue;
    for (std::size_t at = field.offset; at + sizeof(float) <= cloud.data.size(); at += cloud.point_step) {
      float number = 0.0F;
      std::memcpy(&number, &cloud.data[at], sizeof number);
      if (!std::isfinite(number)) return false;
    }
  }
  return true;
}

/// Diagnostics hold them as text.
bool finite(const diagnostic_msgs::DiagnosticArray& report) {
  for (const auto& status : report.status)
    for (const auto& value : status.values)
      if (value.value.find("nan") != std::string::npos || value.value.find("inf") != std::string::npos) return false;
  return true;
}

template <class Message>
bool finite(const Message& message) {
  return all_finite(message);
}

const std::string kImuOdometry = "/imu_odometry";

struct Account {
  std::uint64_t received = 0;
  std::uint64_t lost = 0;        ///< by the sequence numbers that the publisher gives, where there is a header
  std::uint64_t published = 0;   ///< by the same, those before we listened included
  std::uint64_t not_finite = 0;  ///< messages with NaN or inf
};

/// Resident memory of a process [MB]; NaN if it has gone.
double resident_mb(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  double total = NAN, resident = NAN;
  file >> total >> resident;
  return file ? resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6 : NAN;
}

/// The process of a ROS node; 0 as long as it cannot be asked.
int process_of(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = node;
  if (!ros::master::execute("lookupNode", request, response, payload, false)) return 0;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(payload, host, port)) return 0;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue name, answer;
  name[0] = ros::this_node::getName();
  if (!client.execute("getPid", name, answer) || answer.size() != 3) return 0;
  return answer[2];
}

struct Options {
  std::string node = "/lio_manager", filter = "/lidar_odometry", out = ".";
  double interval = 10.0;  ///< between the rows, by the scans' stamps [s]
};

class Watch {
 public:
  explicit Watch(const Options& options) : options_(options), rows_(options.out + "/soak.csv") {
    rows_.precision(9);
    rows_ << "t,wall,rss_mb,map_mb,lag,cpu_ms\n";
    const std::string& f = options.filter;
    listen<nav_msgs::Odometry>(f + "/odometry");
    listen<nav_msgs::Path>(f + "/path");
    listen<sensor_msgs::PointCloud2>(f + "/points");
    listen<sensor_msgs::PointCloud2>(f + "/map");
    listen<allan_lio::State>(f + "/state");
    listen<allan_lio::Status>(f + "/status");
    listen<nav_msgs::Odometry>(kImuOdometry);
    listen<visualization_msgs::MarkerArray>(f + "/markers");
    listen<tf2_msgs::TFMessage>("/tf");
    listen<diagnostic_msgs::DiagnosticArray>("/diagnostics");
    ready_timer_ = handle_.createWallTimer(ros::WallDuration(0.1), &Watch::tell_when_ready, this);
  }

  /// What came on each topic, as a table: complete when the rows are.
  void write_account() {
    std::ofstream file(options_.out + "/topics.csv");
    file << "topic,received,lost,published,not_finite\n";
    for (const auto& [topic, account] : accounts_)
      file << topic << ',' << account.received << ',' << account.lost << ',' << account.published << ','
           << account.not_finite << '\n';
    std::ofstream answers(options_.out + "/imu_answers.csv");
    answers << "superseded,lost\n" << answers_.missing().superseded << ',' << answers_.missing().lost << '\n';
    if (!file.flush() || !answers.flush() || !rows_.flush())
      throw std::runtime_error(options_.out + ": cannot be written");
  }

 private:
  template <class Message>
  void listen(const std::string& topic) {
    Account& account = accounts_[topic];
    const auto take = [this, &account, topic](const boost::shared_ptr<const Message>& message) {
      ++account.received;
      account.not_finite += !finite(*message);
      if constexpr (ros::message_traits::HasHeader<Message>::value) {
        const std::uint64_t seq = std::uint64_t{message->header.seq} + 1;  // roscpp counts from 0 for every topic
        if (account.received > 1) account.lost += seq - account.published - 1;
        account.published = seq;
      }
      if constexpr (std::is_same<Message, allan_lio::Status>::value) add_row(*message);
      if constexpr (std::is_same<Message, allan_lio::State>::value) answers_.saw_state(message->header.stamp);
      if constexpr (std::is_same<Message, nav_msgs::Odometry>::value)
        if (topic == kImuOdometry) answers_.saw_odometry(message->header.stamp);
    };
    constexpr std::uint32_t kWithoutBound = 0;
    subscribers_.push_back(handle_.subscribe<Message>(topic, kWithoutBound, take, ros::VoidConstPtr(),
                                                      ros::TransportHints().tcpNoDelay()));
  }

  /// The file `listening` appears when every topic has its publisher.
  void tell_when_ready(const ros::WallTimerEvent&) {
    for (const ros::Subscriber& subscriber : subscribers_)
      if (subscriber.getNumPublishers() == 0) return;
    std::ofstream(options_.out + "/listening");
    ready_timer_.stop();
  }

  void add_row(const allan_lio::Status& status) {
    if (begin_.isZero()) {
      begin_ = next_ = status.header.stamp;
      wall_begin_ = ros::WallTime::now();
    }
    lag_ = std::max(lag_, status.delay);
    if (status.header.stamp < next_) return;
    next_ += ros::Duration(options_.interval);
    if (pid_ == 0) pid_ = process_of(options_.node);
    rows_ << (status.header.stamp - begin_).toSec() << ',' << (ros::WallTime::now() - wall_begin_).toSec() << ','
          << resident_mb(pid_) << ',' << status.map_mb << ',' << lag_ << ',' << 1e3 * status.scan_time_mean << '\n';
    rows_.flush();
    lag_ = 0.0;
  }

  Options options_;
  std::ofstream rows_;
  ros::NodeHandle handle_;
  std::map<std::string, Account> accounts_;
  std::vector<ros::Subscriber> subscribers_;
  ros::WallTimer ready_timer_;
  allan_lio::ImuAnswers answers_;
  ros::Time begin_, next_;
  ros::WallTime wall_begin_;
  double lag_ = 0.0;  ///< the longest since the last row [s]
  int pid_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "soak_watch");
  CLI::App app{
      "Listens to everything that the nodelets publish until it is interrupted: writes memory, map and lag over time "
      "to "
      "soak.csv, and what came, was lost or was not finite on each topic to topics.csv."};
  Options options;
  app.add_option("--node", options.node, "whose memory is measured")->capture_default_str();
  app.add_option("--filter", options.filter, "the filter's nodelet")->capture_default_str();
  app.add_option("--out", options.out, "directory")->check(CLI::ExistingDirectory)->capture_default_str();
  app.add_option("--interval", options.interval, "between the rows, of the data's time [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    Watch watch(options);
    ros::spin();
    watch.write_account();
  } catch (const std::exception& error) {
    std::cerr << "soak_watch: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
