// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <functional>
#include <string>

#include "allan_lio/ros/param_source.h"
#include "allan_lio/ros/reconfigure.h"

namespace allan_lio {

/// Parameters that change while the filter runs, by `rosparam set` or dynamic_reconfigure. What is refused is set back
/// on the parameter server, and said. Its callbacks must not run at the same time as poll().
class LiveTuning {
 public:
  /// Puts a configuration into force that differs in live parameters only.
  using Apply = std::function<void(const LioConfig&)>;

  LiveTuning(const ros::NodeHandle& private_handle, const NodeParameters& parameters, Apply apply);
  ~LiveTuning();
  LiveTuning(const LiveTuning&) = delete;
  LiveTuning& operator=(const LiveTuning&) = delete;

  /// Takes over what has changed on the parameter server since. Asks the master only when it said that something has.
  void poll();

  const LioConfig& in_force() const { return config_; }

 private:
  const LioConfig& on_request(const ConfigSource& entries);
  void take(const ConfigSource& now);
  /// True if `key` has the value now, whether it had it before or not.
  bool change(const std::string& key, const ConfigEntry& entry);
  /// Puts back what stood there `before`, for a live parameter what is in force.
  void set_back(const std::string& key, const ConfigSource& before);
  void write(const std::string& key, const ConfigEntry& entry);

  ros::NodeHandle handle_;
  std::string root_;  ///< name of the tree on the server
  LioConfig config_;
  ConfigSource known_;             ///< what stands on the server, as far as it has been judged
  XmlRpc::XmlRpcValue last_tree_;  ///< as last seen
  Apply apply_;
  ReconfigureServer server_;
};

}  // namespace allan_lio
