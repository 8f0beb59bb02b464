// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/known_keys.h"

#include <algorithm>
#include <numeric>

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

/// Levenshtein's distance: insertions, deletions and replacements of one character.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string nearest(const std::string& key, const std::vector<std::string>& keys) {
  constexpr std::size_t kCompared = 200;  // [characters] no key is as long; of a damaged file one may be megabytes
  const std::string begin = key.substr(0, kCompared);
  std::vector<std::size_t> distances;
  for (const std::string& known : keys) distances.push_back(edit_distance(begin, known));
  return keys[static_cast<std::size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin())];
}

bool is_group(const std::string& key, const std::vector<std::string>& keys) {
  return std::any_of(keys.begin(), keys.end(),
                     [&key](const std::string& known) { return known.compare(0, key.size() + 1, key + "/") == 0; });
}

bool is_quantity(const std::string& key, const std::vector<std::string>& keys) {
  return std::find(keys.begin(), keys.end(), key + "/unit") != keys.end();
}

}  // namespace

void refuse_unknown_keys(const ConfigSource& source) {
  const std::vector<std::string> keys = known_keys();
  for (const auto& item : source) {
    const std::string& key = item.first;
    if (std::find(keys.begin(), keys.end(), key) != keys.end() || is_quantity(key, keys)) continue;
    const bool group = is_group(key, keys);
    if (group && item.second.items.empty() && !item.second.is_list) continue;
    throw ConfigError("'" + key + "' (" + item.second.origin + ")" +
                      (group ? " is a group of parameters and takes no value of its own; the nearest parameter is '"
                             : " is not a parameter; the nearest one is '") +
                      nearest(key, keys) + "'");
  }
}

}  // namespace allan_lio
