// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/live_tuning.h"

#include <ros/console.h>
#include <ros/param.h>

#include <iterator>
#include <optional>
#include <utility>

#include "allan_lio/io/known_keys.h"
#include "allan_lio/io/live_parameters.h"

namespace allan_lio {
namespace {

bool same_value(const ConfigEntry& a, const ConfigEntry& b) {
  return a.items == b.items && a.is_list == b.is_list && a.senseless == b.senseless;
}

bool is_at_or_below(const std::string& key, const std::string& place) {
  return key == place || key.compare(0, place.size() + 1, place + "/") == 0;
}

}  // namespace

LiveTuning::LiveTuning(const ros::NodeHandle& private_handle, const NodeParameters& parameters, Apply apply)
    : handle_(private_handle),
      root_(private_handle.getNamespace()),
      config_(parameters.config),
      known_(parameters.given),
      apply_(std::move(apply)),
      server_(private_handle, config_,
              [this](const ConfigSource& entries) -> const LioConfig& { return on_request(entries); }) {
  poll();  // subscribes
}

LiveTuning::~LiveTuning() { ros::param::unsubscribeCachedParam(root_); }

void LiveTuning::poll() {
  XmlRpc::XmlRpcValue tree;
  if (!ros::param::getCached(root_, tree) || tree == last_tree_) return;
  last_tree_ = tree;
  take(given_parameters(tree, root_));
}

void LiveTuning::take(const ConfigSource& now) {
  const ConfigSource before = known_;
  // What is deleted stays in force: the next launch clears the tree before this node is gone.
  for (auto it = known_.begin(); it != known_.end();) it = now.count(it->first) == 0 ? known_.erase(it) : std::next(it);
  for (const auto& [key, entry] : now) {
    const auto old = before.find(key);
    if ((old != before.end() && same_value(old->second, entry)) || is_empty_group(key, entry)) continue;
    if (change(key, entry)) {
      known_[key] = entry;
    } else {
      set_back(key, before);
    }
  }
}

bool LiveTuning::change(const std::string& key, const ConfigEntry& entry) {
  try {
    const LioConfig wanted = change_live(config_, key, entry);
    const std::string difference = live_difference(config_, wanted);
    if (difference.empty()) return true;
    apply_(wanted);
    config_ = wanted;
    ROS_INFO_STREAM(difference << ", in force with the next scan (" << entry.origin << "; configuration "
                               << config_hash(config_) << ")");
    show_in_force(handle_, key, to_source(config_).at(key));
    server_.show(config_);
    return true;
  } catch (const ConfigError& error) {
    ROS_ERROR_STREAM("refused: " << error.what() << "; " << what_stays(config_, key));
    return false;
  }
}

void LiveTuning::set_back(const std::string& key, const ConfigSource& before) {
  const std::optional<ParameterEntry> parameter = parameter_at(config_, key);
  const std::string place = parameter ? parameter->info.key : key;
  if (parameter && parameter->info.live) return write(place, {parameter->items, parameter->is_list, "in force"});
  handle_.deleteParam(place);
  for (const auto& [old_key, entry] : before)
    if (is_at_or_below(old_key, place)) write(old_key, entry);
}

void LiveTuning::write(const std::string& key, const ConfigEntry& entry) {
  handle_.setParam(key, to_value(entry));
  known_[key] = entry;
}

const LioConfig& LiveTuning::on_request(const ConfigSource& entries) {
  poll();  // in the order in which they came
  for (const auto& [key, entry] : entries) {
    const LioConfig before = config_;
    if (change(key, entry) && !live_difference(before, config_).empty()) write(key, entry);
  }
  server_.show(config_);  // a client that asked for something else shows what is in force
  return config_;
}

}  // namespace allan_lio
