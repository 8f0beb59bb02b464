// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/serialization.h>
#include <ros/time.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace allan_lio {

/// A file that cannot be read as a bag. what() names the file.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is said once of the messages of a topic from one publisher.
struct BagConnection {
  std::string topic, datatype, md5sum, definition;
  bool latching = false;
};

/// A message as it was recorded.
struct BagMessage {
  ros::Time time;  ///< of its recording
  std::shared_ptr<const BagConnection> connection;
  std::vector<std::uint8_t> bytes;

  /// The message as type M. Throws ros::serialization::StreamOverrunException for damaged bytes.
  template <class M>
  boost::shared_ptr<M> as() const {
    auto message = boost::make_shared<M>();
    // IStream takes a pointer to non-const although it only reads.
    ros::serialization::IStream stream(const_cast<std::uint8_t*>(bytes.data()),
                                       static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::deserialize(stream, *message);
    return message;
  }
};

/// Messages of one bag in the order of recording time.
class BagReader {
 public:
  virtual ~BagReader() = default;
  virtual const std::vector<std::shared_ptr<const BagConnection>>& connections() const = 0;
  virtual ros::Time begin() const = 0;
  virtual ros::Time end() const = 0;

  /// Only these topics from now on. Call it before the first next(); without it, all topics come.
  virtual void select(const std::set<std::string>& topics) = 0;

  /// False at the end of what can be read.
  virtual bool next(BagMessage& message) = 0;

  /// What is wrong with the bag: a sentence, empty if nothing is known to be.
  virtual const std::string& trouble() const = 0;
};

/// Opens a bag by its index, or by reading through it if the index is missing. Throws BagError if the file cannot
/// be opened or is not a bag.
std::unique_ptr<BagReader> open_bag(const std::string& file);

}  // namespace allan_lio
