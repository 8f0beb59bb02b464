// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/live_parameters.h"

#include <algorithm>

#include "allan_lio/io/known_keys.h"

namespace allan_lio {

std::vector<ParameterEntry> live_parameters(const LioConfig& config) {
  std::vector<ParameterEntry> entries = list_parameters(config);
  const auto fixed = [](const ParameterEntry& entry) { return !entry.info.live; };
  entries.erase(std::remove_if(entries.begin(), entries.end(), fixed), entries.end());
  return entries;
}

ConfigSource fixed_parameters(const LioConfig& config) {
  ConfigSource source = to_source(config);
  for (const ParameterEntry& entry : live_parameters(config)) source.erase(entry.info.key);
  return source;
}

std::optional<ParameterEntry> parameter_at(const LioConfig& config, const std::string& key) {
  for (const ParameterEntry& entry : list_parameters(config)) {
    const std::string& own = entry.info.key;
    if (key == own || key.compare(0, own.size() + 1, own + "/") == 0) return entry;
  }
  return std::nullopt;
}

std::string what_stays(const LioConfig& in_force, const std::string& key) {
  const std::optional<ParameterEntry> parameter = parameter_at(in_force, key);
  if (!parameter) return "all that is in force stays";
  return parameter->info.key + " stays " + (parameter->given ? yaml_value(*parameter) : "as it is, not given");
}

LioConfig change_live(const LioConfig& in_force, const std::string& key, const ConfigEntry& value) {
  refuse_unknown_keys({{key, value}});
  const std::vector<ParameterEntry> entries = live_parameters(in_force);
  const auto same = [&key](const ParameterEntry& entry) { return entry.info.key == key; };
  if (std::none_of(entries.begin(), entries.end(), same))
    throw ConfigError(key + " (" + value.origin + "): cannot be changed while the filter runs");
  return read_config(merge(to_source(in_force), {{key, value}}));
}

std::string live_difference(const LioConfig& before, const LioConfig& after) {
  const std::vector<ParameterEntry> old_entries = live_parameters(before), new_entries = live_parameters(after);
  std::string text;
  for (std::size_t i = 0; i < old_entries.size(); ++i) {
    const std::string was = yaml_value(old_entries[i]), is = yaml_value(new_entries[i]);
    if (was != is) text += (text.empty() ? "" : "; ") + old_entries[i].info.key + " " + was + " -> " + is;
  }
  return text;
}

}  // namespace allan_lio
