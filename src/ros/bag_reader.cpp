// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_reader.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <fstream>
#include <map>

#include "allan_lio/ros/bag_salvage.h"
#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

/// A bag with its index, by rosbag's own library.
class IndexedBag : public BagReader {
 public:
  explicit IndexedBag(const std::string& file) : file_(file) {
    bag_.open(file, rosbag::bagmode::Read);
    view_ = std::make_unique<rosbag::View>(bag_);
    begin_ = view_->getBeginTime();
    end_ = view_->getEndTime();
    for (const rosbag::ConnectionInfo* info : view_->getConnections()) connections_.push_back(convert(*info));
    next_ = view_->begin();
  }

  const std::vector<std::shared_ptr<const BagConnection>>& connections() const override { return connections_; }
  ros::Time begin() const override { return begin_; }
  ros::Time end() const override { return end_; }
  const std::string& trouble() const override { return trouble_; }

  void select(const std::set<std::string>& topics) override {
    const std::vector<std::string> names(topics.begin(), topics.end());
    view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(names));
    next_ = view_->begin();
  }

  bool next(BagMessage& message) override {
    if (!trouble_.empty() || next_ == view_->end()) return false;
    try {
      const rosbag::MessageInstance& instance = *next_;
      message.time = instance.getTime();
      message.connection = connection_of(instance);
      message.bytes.resize(instance.size());
      ros::serialization::OStream stream(message.bytes.data(), static_cast<std::uint32_t>(message.bytes.size()));
      instance.write(stream);
      ++next_;
    } catch (const std::exception& error) {
      trouble_ = file_ + " is damaged, reading stopped after " + std::to_string(seconds_between(begin_, message.time)) +
                 " s: " + error.what();
      return false;
    }
    return true;
  }

 private:
  static std::shared_ptr<const BagConnection> convert(const rosbag::ConnectionInfo& info) {
    const auto latching = info.header ? info.header->find("latching") : ros::M_string::const_iterator();
    const bool latched = info.header && latching != info.header->end() && latching->second == "1";
    return std::make_shared<BagConnection>(
        BagConnection{info.topic, info.datatype, info.md5sum, info.msg_def, latched});
  }

  std::shared_ptr<const BagConnection> connection_of(const rosbag::MessageInstance& instance) {
    // One header object per connection for as long as the bag is open.
    std::shared_ptr<const BagConnection>& known = by_header_[instance.getConnectionHeader().get()];
    if (!known)
      known = std::make_shared<BagConnection>(BagConnection{instance.getTopic(), instance.getDataType(),
                                                            instance.getMD5Sum(), instance.getMessageDefinition(),
                                                            instance.isLatching()});
    return known;
  }

  std::string file_;
  rosbag::Bag bag_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator next_;
  ros::Time begin_, end_;
  std::vector<std::shared_ptr<const BagConnection>> connections_;
  std::map<const ros::M_string*, std::shared_ptr<const BagConnection>> by_header_;
  std::string trouble_;
};

void check_magic(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw BagError("cannot open the bag " + file);
  std::string line(13, '\0');
  if (!stream.read(&line[0], static_cast<std::streamsize>(line.size())))
    throw BagError(file + " is not a bag: it is shorter than a bag's first line");
  if (line.compare(0, 9, "#ROSBAG V") != 0) throw BagError(file + " is not a bag: it does not begin with #ROSBAG");
  if (line != "#ROSBAG V2.0\n")
    throw BagError(file + " is a bag of format " + line.substr(9, 3) + ", only 2.0 is read: rosbag fix converts it");
}

}  // namespace

std::unique_ptr<BagReader> open_bag(const std::string& file) {
  check_magic(file);
  try {
    return std::make_unique<IndexedBag>(file);
  } catch (const std::exception& error) {
    return std::make_unique<BagSalvage>(file, error.what());
  }
}

}  // namespace allan_lio
