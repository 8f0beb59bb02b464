// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "allan_lio/ros/bag_reader.h"

namespace allan_lio {

/// Several bags as one, merged by recording time.
class BagSource {
 public:
  /// Throws BagError.
  explicit BagSource(const std::vector<std::string>& files);

  /// Throws BagError unless `topic` is there and is of one of these types; names the topics of them that there are.
  void require(const std::string& topic, const std::vector<std::string>& datatypes) const;

  std::vector<std::shared_ptr<const BagConnection>> connections() const;

  /// Only these topics from now on. Call it before the first next().
  void select(const std::set<std::string>& topics);

  bool next(BagMessage& message);

  ros::Time begin() const;
  ros::Time end() const;

  /// One sentence for each bag that is not whole. Complete only after next() has given false.
  std::vector<std::string> troubles() const;

 private:
  /// A bag and its next message.
  struct Input {
    std::unique_ptr<BagReader> reader;
    BagMessage head;
    bool has_head = false;
  };
  std::vector<Input> inputs_;
  bool started_ = false;
};

/// True if both name the same topic: recordings write names with and without a leading slash.
bool same_topic(const std::string& a, const std::string& b);

}  // namespace allan_lio
