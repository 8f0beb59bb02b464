// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <string>

#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// A tree of ROS parameters as a flat configuration: {imu: {k_gb: 2}} is "imu/k_gb". Numbers keep every bit.
/// `origin`: where the tree stands on the server, for messages. What has no text (nested lists, a date, binary data)
/// is a senseless entry, an empty tree an entry without a value.
ConfigSource flatten_parameters(const XmlRpc::XmlRpcValue& tree, const std::string& origin);

/// What a node of this package reads from its private parameters.
struct NodeParameters {
  LioConfig config;
  std::string out;     ///< ~out: directory of the results, empty for none
  ConfigSource given;  ///< all private parameters as they were read
};

/// The given private parameters, all but ~in_force and ~diagnostic_period (diagnostic_updater's own).
ConfigSource given_parameters(const XmlRpc::XmlRpcValue& tree, const std::string& origin);

/// Reads ~config (a name in config/ or a file) and over it all other private parameters, which have the keys of the
/// YAML; ~out is the node's own. Throws ConfigError.
NodeParameters read_node_parameters(const ros::NodeHandle& private_handle);

/// Sets these parameters, and no others, under ~in_force: not over the given ones, or the next start would take this
/// one's values for the user's.
void show_in_force(const ros::NodeHandle& private_handle, const ConfigSource& parameters);
/// One parameter of it.
void show_in_force(const ros::NodeHandle& private_handle, const std::string& key, const ConfigEntry& entry);

/// An entry as a parameter of the type that the YAML reader would see.
XmlRpc::XmlRpcValue to_value(const ConfigEntry& entry);

}  // namespace allan_lio
