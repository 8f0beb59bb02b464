// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/config_source.h"

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/content_hash.h"
#include "allan_lio/io/noise_keys.h"
#include "allan_lio/io/parameter_list.h"

namespace allan_lio {

ConfigSource merge(ConfigSource base, const ConfigSource& over) {
  drop_replaced_noise(base, over);
  for (const auto& item : over) base[item.first] = item.second;
  return base;
}

std::string print_config(const LioConfig& config) {
  YamlTree tree;
  for (const ParameterEntry& entry : list_parameters(config)) {
    if (entry.given) tree.add(entry.info.key, yaml_value(entry));
  }
  return tree.text();
}

ConfigSource to_source(const LioConfig& config) {
  const std::string origin = "in force";
  ConfigSource source;
  for (const ParameterEntry& entry : list_parameters(config)) {
    if (!entry.given) continue;
    const bool quantity = entry.kind == ParameterEntry::Kind::kQuantity;
    source[entry.info.key + (quantity ? "/value" : "")] = {entry.items, entry.is_list, origin};
    if (quantity) source[entry.info.key + "/unit"] = {{si_unit(entry.dimension)}, false, origin};
  }
  return source;
}

std::string config_hash(const LioConfig& config) { return hash_text(print_config(config)); }

}  // namespace allan_lio
