// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/imu_bag.h"

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Temperature.h>

#include <cstring>
#include <memory>
#include <set>

#include "allan_lio/ros/bag_source.h"
#include "allan_lio/ros/bag_stream.h"

namespace allan_lio {
namespace {

/// Little-endian numbers in a row, as ROS serialises them.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

  bool skip(std::size_t count) {
    if (count > left_) return false;
    at_ += count;
    left_ -= count;
    return true;
  }
  template <class T>
  bool take(T* value) {
    const std::uint8_t* const from = at_;
    if (!skip(sizeof(T))) return false;
    std::memcpy(value, from, sizeof(T));
    return true;
  }
  bool take(Eigen::Vector3d* v) { return take(&v->x()) && take(&v->y()) && take(&v->z()); }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

bool take_header(Bytes& bytes, TimeNs* stamp) {
  std::uint32_t sequence = 0, seconds = 0, nanoseconds = 0, frame_length = 0;
  if (!bytes.take(&sequence) || !bytes.take(&seconds) || !bytes.take(&nanoseconds) || !bytes.take(&frame_length))
    return false;
  *stamp = TimeNs{seconds} * kNsPerSecond + nanoseconds;
  return bytes.skip(frame_length);
}

bool decode_temperature(const std::uint8_t* data, std::size_t size, double* temperature) {
  Bytes bytes(data, size);
  TimeNs stamp = 0;
  return take_header(bytes, &stamp) && bytes.take(temperature);
}

std::string join(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The names under which the bags write the topic of this type, with or without a leading slash.
template <class M>
std::set<std::string> find_topic(const std::vector<std::unique_ptr<BagStream>>& bags, const std::string& wanted) {
  const std::string type = ros::message_traits::datatype<M>();
  std::set<std::string> names, others;
  std::string held;
  for (const auto& bag : bags) {
    for (const auto& connection : bag->connections()) {
      const bool right = connection->datatype == type;
      if (same_topic(connection->topic, wanted)) held = connection->datatype;
      if (!right) continue;
      (wanted.empty() || same_topic(connection->topic, wanted) ? names : others).insert(connection->topic);
      if (connection->md5sum != ros::message_traits::md5sum<M>())
        throw BagError("topic " + connection->topic + " is of another version of " + type);
    }
  }
  if (wanted.empty() && !names.empty()) {
    for (const std::string& name : names)
      if (!same_topic(name, *names.begin()))
        throw BagError("there are several topics of type " + type + ", name one with --topic: " + join(names));
  }
  if (!names.empty()) return names;
  const std::string there =
      others.empty() ? "; there is no topic of type " + type + " at all" : "; of type " + type + ": " + join(others);
  if (wanted.empty()) throw BagError("there is no topic of type " + type);
  throw BagError(held.empty() ? "there is no topic " + wanted + there
                              : "topic " + wanted + " is of type " + held + ", not " + type + there);
}

}  // namespace

bool decode_imu(const std::uint8_t* data, std::size_t size, ImuSample* sample) {
  constexpr std::size_t kCovariance = 9 * sizeof(double), kOrientation = 4 * sizeof(double);
  Bytes bytes(data, size);
  return take_header(bytes, &sample->stamp) && bytes.skip(kOrientation + kCovariance) && bytes.take(&sample->gyro) &&
         bytes.skip(kCovariance) && bytes.take(&sample->accel) && bytes.skip(kCovariance);
}

ImuBagOutcome read_imu_bags(const ImuBagSource& source, const ImuBagSink& sink) {
  std::vector<std::unique_ptr<BagStream>> bags;
  for (const std::string& file : source.bags) bags.push_back(std::make_unique<BagStream>(file));
  const std::set<std::string> imu = find_topic<sensor_msgs::Imu>(bags, source.topic);
  std::set<std::string> topics = imu;
  if (!source.temperature_topic.empty()) {
    const std::set<std::string> names = find_topic<sensor_msgs::Temperature>(bags, source.temperature_topic);
    topics.insert(names.begin(), names.end());
  }
  ImuBagOutcome outcome;
  outcome.topic = *imu.begin();
  ImuSample sample;
  const auto take = [&](const BagStream::Message& message) {
    double temperature = 0.0;
    if (imu.count(message.connection.topic) > 0) {
      decode_imu(message.data, message.size, &sample) ? sink.sample(sample) : static_cast<void>(++outcome.undecodable);
    } else if (decode_temperature(message.data, message.size, &temperature) && sink.temperature) {
      sink.temperature(temperature);
    }
  };
  for (const auto& bag : bags) {
    bag->read(topics, take);
    if (!bag->trouble().empty()) outcome.troubles.push_back(bag->trouble());
  }
  return outcome;
}

}  // namespace allan_lio
