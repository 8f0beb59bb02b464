// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// The flat view of a YAML text; `include` comes out as an entry of that name. `name` is what errors and origins call
/// the text. Throws ConfigError with name and line: not YAML, not a map, a list of lists, a key given twice.
ConfigSource parse_yaml(const std::string& text, const std::string& name);

/// The same for files of other programs: OpenCV's header "%YAML:1.0", which is no YAML, is passed over, and a list of
/// lists (a matrix) comes out as a list without items.
ConfigSource parse_foreign_yaml(const std::string& text, const std::string& name);

/// Loads a YAML configuration. `include: [imu/mti600, lidar/velodyne16]` at its top is loaded first, in that order,
/// and what the file itself says wins. A name (of the file or of an include) is tried as a path (for an include:
/// relative to the including file), then under each of `search_dirs` and their "robots/"; everywhere as it stands
/// and with ".yaml" added. Throws ConfigError with file and line: not found (listing what there is), not YAML, a
/// duplicate key, a cycle.
ConfigSource load_yaml(const std::string& name_or_path, const std::vector<std::string>& search_dirs);

}  // namespace allan_lio
