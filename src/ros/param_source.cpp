// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/param_source.h"

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>

#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/config_dirs.h"

namespace allan_lio {
namespace {

using XmlRpc::XmlRpcValue;

const char* const kInForce = "in_force";
const char* const kDiagnosticPeriod = "diagnostic_period";  // diagnostic_updater's own

/// As a YAML scalar would hold it; nothing for what has no text.
std::optional<std::string> scalar_text(const XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return static_cast<const bool&>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<const int&>(value));
    case XmlRpcValue::TypeString:
      return static_cast<const std::string&>(value);
    case XmlRpcValue::TypeDouble: {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", static_cast<const double&>(value));
      return text;
    }
    default:
      return std::nullopt;
  }
}

void add_item(const XmlRpcValue& value, ConfigEntry& entry) {
  if (const std::optional<std::string> text = scalar_text(value)) {
    entry.items.push_back(*text);
  } else {
    entry.senseless = "neither a number, a text, true or false, nor a list of them";
  }
}

void flatten(const XmlRpcValue& value, const std::string& key, const std::string& root, ConfigSource& source) {
  const bool tree = value.getType() == XmlRpcValue::TypeStruct;
  if (tree)
    for (const auto& member : value)
      flatten(member.second, (key.empty() ? "" : key + "/") + member.first, root, source);
  if (tree && (value.size() > 0 || key.empty())) return;
  ConfigEntry entry;
  entry.origin = "rosparam " + root + (key.empty() ? "" : "/" + key);
  entry.is_list = value.getType() == XmlRpcValue::TypeArray;
  if (entry.is_list) {
    for (int i = 0; i < value.size(); ++i) add_item(value[i], entry);
  } else if (!tree) {
    add_item(value, entry);
  }
  source[key] = entry;
}

/// The value of a key of the node's own, taken out of `source`; empty if it is not set.
std::string take_text(ConfigSource& source, const std::string& key) {
  const auto found = source.find(key);
  if (found == source.end()) return "";
  if (found->second.is_list || found->second.items.empty())
    throw ConfigError(found->second.origin + ": a text is expected");
  const std::string text = found->second.items.front();
  source.erase(found);
  return text;
}

/// The type that the YAML reader would see in the text.
XmlRpcValue typed(const std::string& text) {
  if (text == "true" || text == "false") return XmlRpcValue(text == "true");
  char* end = nullptr;
  const long integer = std::strtol(text.c_str(), &end, 10);
  const bool fits = integer >= std::numeric_limits<int>::min() && integer <= std::numeric_limits<int>::max();
  if (!text.empty() && *end == '\0' && fits) return XmlRpcValue(static_cast<int>(integer));
  const double real = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0') return XmlRpcValue(real);
  return XmlRpcValue(text);
}

}  // namespace

XmlRpcValue to_value(const ConfigEntry& entry) {
  if (!entry.is_list) return typed(entry.items.empty() ? "" : entry.items.front());
  XmlRpcValue list;
  list.setSize(static_cast<int>(entry.items.size()));
  for (std::size_t i = 0; i < entry.items.size(); ++i) list[static_cast<int>(i)] = typed(entry.items[i]);
  return list;
}

ConfigSource flatten_parameters(const XmlRpcValue& tree, const std::string& origin) {
  ConfigSource source;
  flatten(tree, "", origin, source);
  return source;
}

ConfigSource given_parameters(const XmlRpcValue& tree, const std::string& origin) {
  XmlRpcValue own;
  if (tree.getType() != XmlRpcValue::TypeStruct) return {};
  for (const auto& member : tree)
    if (member.first != kInForce && member.first != kDiagnosticPeriod) own[member.first] = member.second;
  return own.valid() ? flatten_parameters(own, origin) : ConfigSource();
}

NodeParameters read_node_parameters(const ros::NodeHandle& private_handle) {
  NodeParameters parameters;
  XmlRpcValue tree;
  if (private_handle.getParam("", tree)) parameters.given = given_parameters(tree, private_handle.getNamespace());
  ConfigSource given = parameters.given;
  parameters.out = take_text(given, "out");
  const std::string name = take_text(given, "config");
  const ConfigSource base = name.empty() ? ConfigSource() : load_yaml(name, config_search_dirs());
  parameters.config = read_config(merge(base, given));
  return parameters;
}

void show_in_force(const ros::NodeHandle& private_handle, const ConfigSource& parameters) {
  private_handle.deleteParam(kInForce);  // what an earlier run left
  for (const auto& [key, entry] : parameters) show_in_force(private_handle, key, entry);
}

void show_in_force(const ros::NodeHandle& private_handle, const std::string& key, const ConfigEntry& entry) {
  private_handle.setParam(std::string(kInForce) + "/" + key, to_value(entry));
}

}  // namespace allan_lio
