// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/sensor_check_bag.h"

#include <sensor_msgs/Imu.h>

#include <algorithm>
#include <map>

#include "allan_lio/ros/bag_source.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/raw_cloud.h"
#include "lidar_probe.h"

namespace allan_lio {
namespace {

/// Takes down the messages of one IMU topic.
class ImuProbe {
 public:
  explicit ImuProbe(const BagConnection& connection) {
    report_.topic = connection.topic;
    report_.datatype = connection.datatype;
  }

  void add(const BagMessage& message) {
    ++messages_;
    try {
      const auto imu = message.as<sensor_msgs::Imu>();
      samples_.push_back(to_imu_sample(*imu));
      delays_.push_back(to_time_ns(message.time) - samples_.back().stamp);
      report_.frames.insert(imu->header.frame_id);
    } catch (const ros::serialization::StreamOverrunException&) {
      ++report_.undecodable;
    }
  }
  std::size_t messages() const { return messages_; }

  SensorCheck::Imu finish() {
    std::vector<TimeNs> stamps;
    for (const ImuSample& sample : samples_) stamps.push_back(sample.stamp);
    report_.stamps = check_stamps(stamps);
    report_.delay = median_seconds(delays_);
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const ImuSample& a, const ImuSample& b) { return a.stamp < b.stamp; });
    report_.readings = check_imu(std::move(samples_));
    return std::move(report_);
  }

 private:
  SensorCheck::Imu report_;
  std::vector<ImuSample> samples_;
  std::vector<TimeNs> delays_;
  std::size_t messages_ = 0;
};

template <class Probe>
using Probes = std::map<std::string, Probe>;

bool is_imu(const BagConnection& c) { return c.datatype == ros::message_traits::datatype<sensor_msgs::Imu>(); }
bool is_cloud(const BagConnection& c) {
  const std::vector<std::string>& types = cloud_datatypes();
  return std::find(types.begin(), types.end(), c.datatype) != types.end();
}

/// The probe of the topic with most messages; the others' topics are named.
template <class Probe>
Probe* fullest(Probes<Probe>& probes, std::vector<std::string>& others) {
  Probe* best = nullptr;
  for (auto& [topic, probe] : probes)
    if (probe.messages() > 0 && (best == nullptr || probe.messages() > best->messages())) best = &probe;
  for (auto& [topic, probe] : probes)
    if (&probe != best) others.push_back(topic);
  return best;
}

std::set<std::string> choose_topics(const BagSource& bags, const std::string& imu_topic,
                                    const std::string& lidar_topic) {
  std::set<std::string> topics;
  for (const auto& c : bags.connections()) {
    const std::string& wanted = is_imu(*c) ? imu_topic : lidar_topic;
    if ((is_imu(*c) || is_cloud(*c)) && (wanted.empty() || same_topic(wanted, c->topic))) topics.insert(c->topic);
  }
  return topics;
}

}  // namespace

SensorCheck check_bags(const std::vector<std::string>& files, const std::string& imu_topic,
                       const std::string& lidar_topic, const std::function<bool(double)>& progress) {
  BagSource bags(files);
  if (!imu_topic.empty()) bags.require(imu_topic, {ros::message_traits::datatype<sensor_msgs::Imu>()});
  if (!lidar_topic.empty()) bags.require(lidar_topic, cloud_datatypes());
  SensorCheck check;
  check.files = files;
  for (const auto& c : bags.connections()) check.topics.push_back({c->topic, c->datatype});
  const std::set<std::string> topics = choose_topics(bags, imu_topic, lidar_topic);

  Probes<ImuProbe> imus;
  Probes<LidarProbe> lidars;
  const double length = seconds_between(bags.begin(), bags.end());
  if (!topics.empty()) bags.select(topics);
  BagMessage message;
  while (!topics.empty() && bags.next(message)) {
    const BagConnection& c = *message.connection;
    if (is_imu(c)) imus.try_emplace(c.topic, c).first->second.add(message);
    if (is_cloud(c)) lidars.try_emplace(c.topic, c).first->second.add(message);
    const double part = length > 0.0 ? seconds_between(bags.begin(), message.time) / length : 1.0;
    if (progress && !progress(part)) throw BagError("stopped while the bag was read");
  }
  if (ImuProbe* imu = fullest(imus, check.other_topics)) check.imu = imu->finish();
  if (LidarProbe* lidar = fullest(lidars, check.other_topics)) check.lidar = lidar->finish();
  check.troubles = bags.troubles();
  return check;
}

}  // namespace allan_lio
