// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace allan_lio {

/// A YAML double-quoted scalar.
std::string yaml_quoted(const std::string& text);

}  // namespace allan_lio
