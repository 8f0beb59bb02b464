// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/known_keys.h"

#include <algorithm>

#include "allan_lio/io/edit_distance.h"
#include "allan_lio/io/parameter_list.h"

namespace allan_lio {
namespace {

/// Every key that a source may hold; a quantity is three of them.
std::vector<std::string> known_keys() {
  std::vector<std::string> keys;
  for (const ParameterEntry& entry : list_parameters(default_config(NoiseSpec()))) {
    if (entry.kind == ParameterEntry::Kind::kQuantity) {
      keys.push_back(entry.info.key + "/value");
      keys.push_back(entry.info.key + "/unit");
      keys.push_back(entry.info.key + "/rate");
    } else {
      keys.push_back(entry.info.key);
    }
  }
  return keys;
}

std::string nearest(const std::string& key, const std::vector<std::string>& keys) {
  const EditDistance distance(key);
  std::vector<std::size_t> distances;
  for (const std::string& known : keys) distances.push_back(distance.to(known));
  return keys[static_cast<std::size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin())];
}

bool is_group(const std::string& key, const std::vector<std::string>& keys) {
  return std::any_of(keys.begin(), keys.end(),
                     [&key](const std::string& known) { return known.compare(0, key.size() + 1, key + "/") == 0; });
}

bool is_quantity(const std::string& key, const std::vector<std::string>& keys) {
  return std::find(keys.begin(), keys.end(), key + "/unit") != keys.end();
}

bool has_no_value(const ConfigEntry& entry) { return entry.items.empty() && !entry.is_list && entry.senseless.empty(); }

}  // namespace

void refuse_unknown_keys(const ConfigSource& source) {
  const std::vector<std::string> keys = known_keys();
  for (const auto& item : source) {
    const std::string& key = item.first;
    if (std::find(keys.begin(), keys.end(), key) != keys.end() || is_quantity(key, keys)) continue;
    const bool group = is_group(key, keys);
    if (group && has_no_value(item.second)) continue;
    throw ConfigError("'" + key + "' (" + item.second.origin + ")" +
                      (group ? " is a group of parameters and takes no value of its own; the nearest parameter is '"
                             : " is not a parameter; the nearest one is '") +
                      nearest(key, keys) + "'");
  }
}

bool is_empty_group(const std::string& key, const ConfigEntry& entry) {
  if (!has_no_value(entry)) return false;
  const std::vector<std::string> keys = known_keys();
  return is_group(key, keys) && !is_quantity(key, keys);
}

}  // namespace allan_lio
