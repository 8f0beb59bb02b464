// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/reconfigure.h"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "allan_lio/io/live_parameters.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/ros/stopped_at_start.h"

namespace allan_lio {
namespace {

using dynamic_reconfigure::Config;
using Kind = ParameterEntry::Kind;

/// Clients show the parameters of one group; more would only nest them.
const char* const kGroup = "Default";

const char* type_name(Kind kind) {
  if (kind == Kind::kNumber) return "double";
  if (kind == Kind::kInteger) return "int";
  return kind == Kind::kFlag ? "bool" : "str";
}

template <class List, class Value>
void put(List& list, const std::string& name, Value value) {
  list.emplace_back();
  list.back().name = name;
  list.back().value = value;
}

void put(Config& message, const ParameterEntry& entry, const std::string& value) {
  const std::string& key = entry.info.key;
  if (entry.kind == Kind::kNumber) return put(message.doubles, key, std::strtod(value.c_str(), nullptr));
  if (entry.kind == Kind::kInteger)
    return put(message.ints, key, static_cast<int>(std::strtod(value.c_str(), nullptr)));
  if (entry.kind == Kind::kFlag) return put(message.bools, key, value == "true");
  put(message.strs, key, value);
}

/// An integer has no infinity.
std::string bound(const ParameterEntry& entry, double value) {
  if (entry.kind == Kind::kInteger) value = std::min(std::max(value, -2147483648.0), 2147483647.0);
  return number_text(value);
}

Config config_of(const LioConfig& config, std::string (*value)(const ParameterEntry&)) {
  Config message;
  for (const ParameterEntry& entry : live_parameters(config)) put(message, entry, value(entry));
  message.groups.resize(1);
  message.groups[0].name = kGroup;
  message.groups[0].state = true;
  return message;
}

}  // namespace

dynamic_reconfigure::ConfigDescription to_description(const LioConfig& config) {
  dynamic_reconfigure::ConfigDescription message;
  message.groups.resize(1);
  message.groups[0].name = kGroup;
  for (const ParameterEntry& entry : live_parameters(config)) {
    dynamic_reconfigure::ParamDescription parameter;
    const std::string unit = entry.info.unit == "1" ? "" : " [" + entry.info.unit + "]";
    const std::string range = range_text(entry.range);
    parameter.name = entry.info.key;
    parameter.type = type_name(entry.kind);
    parameter.description = entry.info.sentence + unit + (range.empty() ? "" : " " + range);
    message.groups[0].parameters.push_back(parameter);
  }
  message.min = config_of(config, [](const ParameterEntry& entry) { return bound(entry, entry.range.low); });
  message.max = config_of(config, [](const ParameterEntry& entry) { return bound(entry, entry.range.high); });
  message.dflt = to_config_message(default_config(config.imu.spec));
  return message;
}

Config to_config_message(const LioConfig& config) {
  return config_of(config, [](const ParameterEntry& entry) { return entry.items.front(); });
}

ConfigSource to_entries(const Config& request) {
  ConfigSource entries;
  const auto add = [&entries](const std::string& key, const std::string& value) {
    entries[key] = {{value}, false, "dynamic_reconfigure"};
  };
  for (const auto& item : request.doubles) add(item.name, number_text(item.value));
  for (const auto& item : request.ints) add(item.name, std::to_string(item.value));
  for (const auto& item : request.bools) add(item.name, item.value ? "true" : "false");
  for (const auto& item : request.strs) add(item.name, item.value);
  return entries;
}

ReconfigureServer::ReconfigureServer(ros::NodeHandle private_handle, const LioConfig& in_force, OnRequest on_request)
    : on_request_(std::move(on_request)),
      descriptions_(
          private_handle.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true)),
      updates_(private_handle.advertise<Config>("parameter_updates", 1, true)) {
  require_running();
  descriptions_.publish(to_description(in_force));
  show(in_force);
  service_ = private_handle.advertiseService("set_parameters", &ReconfigureServer::on_service, this);
}

void ReconfigureServer::show(const LioConfig& in_force) { updates_.publish(to_config_message(in_force)); }

bool ReconfigureServer::on_service(dynamic_reconfigure::Reconfigure::Request& request,
                                   dynamic_reconfigure::Reconfigure::Response& response) {
  response.config = to_config_message(on_request_(to_entries(request.config)));
  return true;
}

}  // namespace allan_lio
