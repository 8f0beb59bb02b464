// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

namespace allan_lio {

/// Bytes that operator new has given to this thread since it began, whether they were given back or not: of the whole
/// test program, whose operator new it replaces. Nothing under a sanitizer.
std::optional<std::size_t> bytes_allocated();

}  // namespace allan_lio
