// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace allan_lio {

/// The page doc/parameters.md: a table of every declared parameter.
std::string parameters_markdown();

/// The file config/lio.yaml: every parameter with its default below a comment that says what it is.
std::string parameters_yaml();

}  // namespace allan_lio
