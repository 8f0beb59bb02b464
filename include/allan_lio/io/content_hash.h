// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace allan_lio {

/// 16 hexadecimal digits: the bytes' FNV-1a hash.
std::string hash_text(const std::string& bytes);

/// Tells this build of the estimator from another: the hash of the file that its code was loaded from (the core's
/// library, or the program that it is linked into). Throws std::runtime_error naming the file if it cannot be read.
std::string build_hash();

}  // namespace allan_lio
