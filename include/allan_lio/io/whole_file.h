// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace allan_lio {

/// Throws std::runtime_error naming the path if a file cannot be written there. Leaves what is there as it is.
void check_writable(const std::string& path);

/// Writes a file in one piece: under another name beside it, which then takes its place. What is not a regular file,
/// such as /dev/stdout, is written to directly. Throws std::runtime_error naming the path.
void write_whole(const std::string& path, const std::string& text);

}  // namespace allan_lio
