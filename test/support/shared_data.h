// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace allan_lio {

/// A folder of the recordings that are too large for the repository: in $ALLAN_LIO_DATA, or in shared/data beside the
/// source tree. Empty if it is not there.
inline std::string shared_data(const std::string& name) {
  const char* root = std::getenv("ALLAN_LIO_DATA");
  const std::string path = std::string(root ? root : ALLAN_LIO_SOURCE_DIR "/../shared/data") + "/" + name;
  return std::filesystem::is_directory(path) ? path : "";
}

}  // namespace allan_lio
