// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>

#include <functional>

#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// The live parameters as dynamic_reconfigure's clients (rqt_reconfigure, dynparam) want them: names, types, ranges and
/// sentences from the one declaration, values from `config`.
dynamic_reconfigure::ConfigDescription to_description(const LioConfig& config);
dynamic_reconfigure::Config to_config_message(const LioConfig& config);

/// What a client asks for, one entry a parameter.
ConfigSource to_entries(const dynamic_reconfigure::Config& request);

/// The server's side of dynamic_reconfigure: ~set_parameters, ~parameter_descriptions, ~parameter_updates.
class ReconfigureServer {
 public:
  /// Takes a request, and gives the configuration that is in force after it.
  using OnRequest = std::function<const LioConfig&(const ConfigSource&)>;

  ReconfigureServer(ros::NodeHandle private_handle, const LioConfig& in_force, OnRequest on_request);

  /// Tells the clients what is in force.
  void show(const LioConfig& in_force);

 private:
  bool on_service(dynamic_reconfigure::Reconfigure::Request& request,
                  dynamic_reconfigure::Reconfigure::Response& response);

  OnRequest on_request_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

}  // namespace allan_lio
