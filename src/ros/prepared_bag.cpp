// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/prepared_bag.h"

#include <cstdint>
#include <stdexcept>

#include "allan_lio/lidar/thin_scan.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/decode_cloud.h"
#include "allan_lio/ros/lio_bag.h"
#include "allan_lio/ros/recording_watch.h"

namespace allan_lio {
namespace {

std::string joined(const std::vector<std::string>& files) {
  std::string text;
  for (const std::string& file : files) text += (text.empty() ? "" : ", ") + file;
  return text;
}

/// Takes the messages as LioSession does, but keeps them.
class Recorder {
 public:
  Recorder(const LioConfig& config, std::string files)
      : config_(config), files_(std::move(files)), decoder_(config.lidar) {}

  void add(const BagMessage& message) {
    try {
      take_lio_message(
          message, config_.topics, [this](const sensor_msgs::Imu& imu) { add(imu); },
          [this](const RawCloud& cloud) { add(cloud); });
    } catch (const ros::serialization::StreamOverrunException&) {
      refuse("its bytes end too early");
    }
  }

  PreparedBag finish(const std::vector<std::string>& troubles) {
    std::string also;
    for (const std::string& trouble : troubles) also += "; " + trouble;
    if (record_.scans() == 0 && undecodable_ > 0)
      throw BagError(files_ + ": no cloud could be decoded: " + last_refusal_ + also);
    if (record_.scans() == 0) throw BagError(files_ + ": no scan came" + also);
    if (record_.imu().empty()) throw BagError(files_ + ": no IMU sample came" + also);
    PreparedBag bag;
    if (!decoder_.verdict().empty()) bag.notes.push_back(decoder_.verdict());
    for (const std::string& remark : decoder_.remarks()) bag.notes.push_back(remark);
    if (undecodable_ > 0)
      bag.notes.push_back(std::to_string(undecodable_) + " messages could not be decoded; the last: " + last_refusal_);
    bag.notes.insert(bag.notes.end(), troubles.begin(), troubles.end());
    record_.shrink();
    bag.record = std::move(record_);
    return bag;
  }

 private:
  /// Clouds in a row that may fail before the bag is given up.
  static constexpr std::uint64_t kHopelessClouds = 50;

  void add(const sensor_msgs::Imu& message) {
    const ImuSample sample = to_imu_sample(message);
    if (watch_.begins_anew(sample.stamp))
      throw BagError(files_ + ": the stamps go back by " +
                     std::to_string(seconds_between(sample.stamp, watch_.newest())) +
                     " s: it holds more than one recording, and a trial is a run on one");
    record_.add(sample);
  }

  void add(const RawCloud& message) {
    const DecodedCloud decoded = decoder_.decode(message);
    if (!decoded.scan) return refuse(decoded.error);
    record_.add(thin_scan(*decoded.scan, config_.map.insert_leaf, config_.lidar.leaf, downsampler_));
  }

  void refuse(const std::string& why) {
    last_refusal_ = why;
    if (++undecodable_ >= kHopelessClouds && record_.scans() == 0)
      throw BagError(files_ + ": no cloud could be decoded: " + last_refusal_);
  }

  const LioConfig& config_;
  const std::string files_;
  CloudDecoder decoder_;
  ScanDownsampler downsampler_;
  RecordingWatch watch_;
  PreparedRecord record_;
  std::uint64_t undecodable_ = 0;
  std::string last_refusal_;
};

void add_reference(const std::string& file, const std::string& bags, PreparedRecord& record) {
  Trajectory reference = read_tum(file);
  try {
    record.set_reference(std::move(reference));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": cannot serve as the truth of " + bags + ": " + error.what());
  }
}

}  // namespace

PreparedBag prepare_bag(const std::vector<std::string>& files, const LioConfig& config, const std::string& reference,
                        const GoOn& go_on) {
  BagSource bags = open_lio_bags(files, config.topics);
  Recorder recorder(config, joined(files));
  const double length = seconds_between(bags.begin(), bags.end());
  BagMessage message;
  while (bags.next(message)) {
    recorder.add(message);
    const double part = length > 0.0 ? seconds_between(bags.begin(), message.time) / length : 1.0;
    if (go_on && !go_on(part)) throw BagError(joined(files) + ": stopped while it was read");
  }
  PreparedBag bag = recorder.finish(bags.troubles());
  if (!reference.empty()) add_reference(reference, joined(files), bag.record);
  return bag;
}

}  // namespace allan_lio
